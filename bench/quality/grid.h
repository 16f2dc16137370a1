#pragma once

#include <string>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/lod/simplify.h>

#include "models.h"

namespace lodestone::bench {

/// One point of a grid of settings.
struct Setting {
  std::string text;  ///< as given
  SimplifyOptions options;
  bool with_attributes = false;  ///< a weight was given: meshes keep their attributes
};

/// Reads words separated by commas: a metric's name, `density`, `current`, `lock-border`, `crease=DEG`, or a weight
/// such as `normal=0.5` (normal, texcoord, color, skin, target). Errors: InvalidArgument, naming the word.
Result<Setting> parse_setting(const std::string& text);

/// The settings that are tried where none are given.
std::vector<std::string> default_settings();

/// Runs every setting over every model and ratio and prints a Markdown line for each: geometric means as multiples of
/// the first setting's.
void run_grid(const std::vector<Setting>& settings, const Models& models, const std::vector<double>& ratios,
              std::size_t samples);

}  // namespace lodestone::bench

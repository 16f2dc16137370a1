#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include <lodestone/core/result.h>
#include <lodestone/lod/deviation.h>

#include "command.h"

namespace CLI {
class App;
}

namespace lodestone::tool {

/// `lodestone compare`: the distance between two surfaces, both ways.
struct CompareCommand {
  std::filesystem::path first;
  std::filesystem::path second;
  bool json = false;
  std::size_t samples = DeviationOptions{}.sample_count;  ///< of each surface, about
  std::optional<std::filesystem::path> html;
  std::optional<std::filesystem::path> heatmap;

  void add_to(CLI::App& app);
  Result<Outcome> run() const;
};

}  // namespace lodestone::tool

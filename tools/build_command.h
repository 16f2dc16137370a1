#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/effort.h>
#include <lodestone/core/result.h>

#include "command.h"
#include "file_words.h"
#include "target_options.h"

namespace CLI {
class App;
}

namespace lodestone::tool {

class MadeFolders;

/// `lodestone build`: a scene or mesh file in, a progressive multi-LOD .glb or .gltf out; or several, each for itself.
/// With the profile "level" it is what SimplifyCommand makes.
struct BuildCommand {
  FileWords files;
  std::string format = "glb";   ///< of what goes into a folder or to the standard output; or gltf, lods, obj, ply
  std::string input_format;     ///< of the standard input, an extension without the dot; empty: go by the content
  std::filesystem::path input;  ///< one of the files, as the next
  std::filesystem::path output;
  std::optional<std::filesystem::path> report;
  std::optional<std::filesystem::path> html;
  std::string metric = "hybrid";
  std::string normalisation = "integral";
  std::string reference = "original";
  std::optional<int> level_count;  ///< with --ratio only, the whole mesh included; 5 if not given
  TargetOptions targets;
  bool per_mesh = false;
  bool lock_border = false;
  bool vanish = false;
  std::optional<double> crease_angle;  ///< degrees
  std::vector<std::string> weights;    ///< "NAME=FACTOR"
  std::string importance;              ///< an attribute's name
  std::optional<std::filesystem::path> settings;
  std::string placement = "optimised";
  std::string profile = "msft-lod";
  bool no_stream = false;
  bool lossless = false;
  std::optional<std::string> stream_coding;  ///< "small" or "fast"; unset: by effort
  std::string compression = "draco";         ///< or "meshopt", "none"
  std::optional<int> position_bits;          ///< unset: 14, or what the shape needs
  std::optional<double> grid_step;           ///< in place of bits
  std::vector<double> grid_origin{0, 0, 0};
  int effort = kDefaultEffort;
  std::size_t thread_count = 0;  ///< 0: as many as the machine has cores
  bool quiet = false;
  bool strict = false;

  void add_to(CLI::App& app);
  /// Errors: any; nothing is written then of an input that has one.
  Result<Outcome> run() const;

 protected:
  void add_run_options(CLI::App& app);
  void add_level_options(CLI::App& app);
  void add_metric_options(CLI::App& app);
  void add_control_options(CLI::App& app);
  void add_profile_options(CLI::App& app);
  void add_storage_options(CLI::App& app);

 private:
  Result<std::vector<BuildCommand>> split(MadeFolders& folders) const;
};

/// `lodestone simplify`: a scene or mesh file in, one file with fewer faces out, and nothing beside them.
struct SimplifyCommand : BuildCommand {
  SimplifyCommand() { profile = "level"; }
  void add_to(CLI::App& app);
};

}  // namespace lodestone::tool

#pragma once

#include <filesystem>

#include <lodestone/core/result.h>

#include "command.h"
#include "target_options.h"

namespace CLI {
class App;
}

namespace lodestone::tool {

/// `lodestone extract`: one level out of a .glb's removal stream.
struct ExtractCommand {
  std::filesystem::path input;
  std::filesystem::path output;
  TargetOptions target;
  bool quiet = false;
  bool strict = false;

  void add_to(CLI::App& app);
  /// Errors: any; nothing is written then.
  Result<Outcome> run() const;
};

}  // namespace lodestone::tool

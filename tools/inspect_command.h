#pragma once

#include <filesystem>

#include <lodestone/core/result.h>

#include "command.h"

namespace CLI {
class App;
}

namespace lodestone::tool {

/// `lodestone inspect`: what a mesh file or a multi-LOD .glb holds.
struct InspectCommand {
  std::filesystem::path input;
  bool stream = false;
  bool json = false;

  void add_to(CLI::App& app);
  Result<Outcome> run() const;
};

}  // namespace lodestone::tool

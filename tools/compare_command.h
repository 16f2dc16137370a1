#pragma once

#include <filesystem>

#include <lodestone/core/result.h>

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

  void add_to(CLI::App& app);
  Result<Outcome> run() const;
};

}  // namespace lodestone::tool

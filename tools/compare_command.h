#pragma once

#include <filesystem>
#include <optional>

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
  std::optional<std::filesystem::path> html;
  std::optional<std::filesystem::path> heatmap;

  void add_to(CLI::App& app);
  Result<Outcome> run() const;
};

}  // namespace lodestone::tool

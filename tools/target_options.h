#pragma once

#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "level_target.h"

namespace CLI {
class App;
}

namespace lodestone::tool {

/// The options that say how far to simplify; at most one of them is given.
struct TargetOptions {
  std::optional<std::string> ratio;
  std::optional<std::string> faces;    ///< comma-separated whole numbers
  std::optional<std::string> error;    ///< comma-separated error sizes
  std::optional<std::string> epsilon;  ///< comma-separated numbers

  /// Adds them to a command, under a heading of its help; `lists` says there whether it takes several values.
  void add_to(CLI::App& app, const char* group, bool lists);
  /// Returns the targets in the order given; none if no option is.
  /// Errors: InvalidArgument for more than one option, or a value that is wrong, naming it.
  Result<std::vector<LevelTarget>> parse() const;

 private:
  int given_count() const;
};

}  // namespace lodestone::tool

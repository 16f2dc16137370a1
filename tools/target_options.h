#pragma once

#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/pipeline/level_target.h>

namespace CLI {
class App;
}

namespace lodestone::tool {

/// The options that say how far to simplify; at most one of them is given, but one error may limit the others. A list's
/// values stand between commas or spaces, `10 %` is one of them.
struct TargetOptions {
  std::vector<std::string> ratio;    ///< shares, as the next in one or more lists
  std::vector<std::string> faces;    ///< whole numbers
  std::vector<std::string> error;    ///< error sizes
  std::vector<std::string> epsilon;  ///< numbers

  /// Adds them to a command, under a heading of its help; `lists` and `limits` say there whether it takes several
  /// values, and an error beside other targets.
  void add_to(CLI::App& app, const char* group, bool lists, bool limits);
  struct Parsed {
    std::vector<LevelTarget> targets;  ///< in the order given; none if no option is
    std::optional<LevelTarget> limit;  ///< an error that stops them all
  };
  /// Errors: InvalidArgument for options that do not go together, or a value that is wrong, naming it.
  Result<Parsed> parse() const;
  /// Whether one share is asked for, which then holds from each level to the next.
  bool is_one_ratio() const;
  /// Returns a sentence for each error that may not mean what its number says: a plain one that is large for a scene of
  /// this diagonal, a length where the file's unit is not known to be the metre. Pre: `parse` has no error.
  std::vector<std::string> remarks(double diagonal, bool in_metres) const;

 private:
  int given_count() const;
};

}  // namespace lodestone::tool

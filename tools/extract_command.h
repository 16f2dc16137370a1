#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <lodestone/core/result.h>

#include "command.h"
#include "file_words.h"
#include "target_options.h"

namespace CLI {
class App;
}

namespace lodestone::tool {

/// `lodestone extract`: one level out of a file's removal stream, or one of its levels.
struct ExtractCommand {
  FileWords files;
  std::string format = "glb";  ///< of what goes into a folder or to the standard output
  TargetOptions target;
  std::optional<std::size_t> level;  ///< of those in the file, instead of a target
  bool quiet = false;
  bool strict = false;

  void add_to(CLI::App& app);
  /// Errors: any; nothing is written then.
  Result<Outcome> run() const;
};

}  // namespace lodestone::tool

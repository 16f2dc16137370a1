#pragma once

#include <string>
#include <vector>

#include <lodestone/core/result.h>

namespace CLI {
class App;
}

namespace lodestone::tool {

/// Returns a command line in the one spelling that the parser of `program` takes, whatever users type:
///   IN OUT                    build IN OUT; so is any line that begins with an option or a file
///   help, help COMMAND        --help, COMMAND --help; `version` alike
///   --ratio 0.5 build IN      build --ratio 0.5 IN
///   -o=OUT, --output=OUT      --output OUT
///   --ratio 0.5, 0.25 10 %    --ratio "0.5, 0.25 10 %"
/// Errors: InvalidArgument for options and commands that there are none of, all of them in the order typed, with what
/// may be meant; for an option without its value, or given twice.
Result<std::vector<std::string>> spell_out(const CLI::App& program, std::vector<std::string> words);

}  // namespace lodestone::tool

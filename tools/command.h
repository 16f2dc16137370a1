#pragma once

#include <lodestone/core/result.h>

namespace lodestone::tool {

/// How a command that did not fail ended. A target that could not be met is a result, not an error.
enum class Outcome {
  Done,
  TargetNotMet,  ///< with --strict only; nothing was written
};

}  // namespace lodestone::tool

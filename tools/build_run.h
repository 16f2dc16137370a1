#pragma once

#include <lodestone/core/result.h>

#include "build_command.h"
#include "command.h"

namespace lodestone::tool {

/// Does what the options of `lodestone build` say: reads, simplifies, measures levels, writes and reports.
/// Errors: any; nothing is written then.
Result<Outcome> run_build(const BuildCommand& options);

}  // namespace lodestone::tool

#pragma once

#include <lodestone/core/result.h>

#include "build_command.h"
#include "build_report.h"
#include "command.h"
#include "progress_bar.h"

namespace lodestone::tool {

struct FinishedBuild {
  Outcome outcome = Outcome::Done;
  BuildReport report;  ///< complete only where the outcome is Done
};

/// Does what a `lodestone build` asks for: reads, builds, writes and reports. `bar` is at the beginning of this piece
/// of the work. Errors: any; nothing is written then.
Result<FinishedBuild> run_build(const BuildCommand& command, ProgressBar& bar);

}  // namespace lodestone::tool

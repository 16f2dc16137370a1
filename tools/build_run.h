#pragma once

#include <lodestone/core/result.h>

#include "build_command.h"
#include "build_report.h"
#include "command.h"
#include "progress_bar.h"

namespace lodestone::tool {

struct BuildResult {
  Outcome outcome = Outcome::Done;
  BuildReport report;  ///< complete only where the outcome is Done
};

/// Does what the options of `lodestone build` say of their input and output: reads, simplifies, measures levels, writes
/// and reports. `progress` is at the beginning of this piece of the work. Errors: any; nothing is written then.
Result<BuildResult> run_build(const BuildCommand& options, ProgressBar& progress);

}  // namespace lodestone::tool

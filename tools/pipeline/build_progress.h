#pragma once

#include <lodestone/core/detail/cancelled.h>
#include <lodestone/core/progress.h>
#include <lodestone/pipeline/build_asset.h>

namespace lodestone::detail {

/// Returns the progress of what is done between two shares of a stage, for the observer, which hears at once that the
/// first is reached.
Progress stage_progress(BuildObserver& observer, BuildStage stage, double begin = 0, double end = 1);

}  // namespace lodestone::detail

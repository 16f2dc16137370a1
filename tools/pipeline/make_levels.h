#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/level_plan.h"
#include "pipeline/scene_fitter.h"

namespace lodestone::detail {

/// Extracts each mesh's levels from its stream and fits them to the original, unless an error was asked for that only
/// the stream's level keeps to. Errors: Cancelled.
Result<std::vector<LeveledMesh>> make_levels(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                                             const LevelPlan& plan, SceneFitter& fitter, const Progress& progress);

}  // namespace lodestone::detail

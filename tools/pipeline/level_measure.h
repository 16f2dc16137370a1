#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/build_effort.h"
#include "pipeline/level_plan.h"

namespace lodestone::detail {

/// Whether the two surfaces are nowhere farther from each other than `limit`, in mesh units.
bool lies_within(const MeasuredSurface& a, const Mesh& b, double limit, const BuildEffort& effort,
                 const Progress& progress);

/// Returns a bound on how far the two surfaces are from each other anywhere, in mesh units.
double measured_maximum(const MeasuredSurface& a, const Mesh& b, const BuildEffort& effort, const Progress& progress);

/// Which of a plan's levels one of its files holds.
struct FileLevels {
  std::size_t file = 0, file_count = 1;
  std::size_t first = 0;  ///< its first level's number in the plan
};

/// Measures levels as a file has them, by mesh: sets their deviations, and fills in `result` what it reports of them.
/// What is all of a mesh, as it was, deviates by nothing. Errors: Cancelled.
Result<void> measure_levels(MeasuredScene& measured, const LevelPlan& plan, const BuildOptions& options,
                            const FileLevels& file, std::vector<std::vector<AssetLevel>>& meshes, BuildResult& result,
                            BuildObserver& observer);

}  // namespace lodestone::detail

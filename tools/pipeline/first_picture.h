#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/placed_level.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_options.h>

#include "pipeline/level_plan.h"
#include "pipeline/measured_scene.h"
#include "pipeline/scene_fitter.h"

namespace lodestone::detail {

/// Returns after how many bytes at most a file of so many should be drawable: 4,096 or a hundredth, whichever is more.
std::uint64_t first_picture_limit(std::uint64_t file_bytes);

/// Makes the last level of a plan coarser, so that the first picture of a refined file comes within its limit. Where
/// that would leave too little to look at, as where the document alone is longer, the level stays as it is. Returns
/// whether it is another. Pre: levels as planned, with their streams. Errors: those of encoding; Cancelled.
Result<bool> fit_first_picture(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                               const BuildOptions& options, SceneFitter& fitter, const Progress& progress,
                               LevelPlan& plan, std::vector<LeveledMesh>& levels);

/// Encodes a stream as `encode_compact` does. Where its first chunk ends behind the limit of a first picture, it gets
/// an earlier end, at a level whose vertices lie where the first of `placed` has them. `original`: the full mesh, to
/// measure that by; null where no levels are placed.
Result<CompactStream> encode_early_picture(const ProgressiveMesh& mesh, const CompactOptions& options,
                                           std::vector<PlacedLevel> placed, const MeasuredSurface* original);

}  // namespace lodestone::detail

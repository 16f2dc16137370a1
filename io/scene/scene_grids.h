#pragma once

#include <span>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/scene.h>

#include "gltf/draco_encode.h"
#include "scene/scene_primitives.h"

namespace lodestone::detail {

/// Fits the grids of each of a scene's meshes, over all its levels: levels of different grids would not fit together.
/// Meshes of equal scale share their grid of positions, since they may touch; its step is as fine as the finest of them
/// needs, unless the options say how many bits there are; all share one where the options give it. Attribute grids
/// stand by column; where no grid holds the values well enough, they stay exact. Shapes: `levels[mesh][level]`. Errors:
/// InvalidArgument where the options' grid is too fine for how far positions lie from its origin.
Result<std::vector<QuantizationGrids>> fit_grids(const Scene& scene, std::span<const std::vector<LevelGeometry>> levels,
                                                 const AssetOptions& options);

}  // namespace lodestone::detail

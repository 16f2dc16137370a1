#pragma once

#include <span>
#include <vector>

#include <lodestone/core/progress.h>
#include <lodestone/io/asset.h>

#include "gltf/draco_encode.h"
#include "scene/scene_impl.h"
#include "scene/scene_primitives.h"

namespace lodestone::detail {

/// A level of a mesh that is to be written.
struct LevelToEncode {
  const MeshSource* source = nullptr;
  const LevelGeometry* level = nullptr;
  const QuantizationGrids* grids = nullptr;
};

/// Splits levels by material and, with Draco, encodes what each has of a material, all side by side. Nothing that Draco
/// refuses is an error here: it is in the outputs. Where the work is cancelled they are of no use.
std::vector<EncodedLevel> encode_levels(std::span<const LevelToEncode> levels, const AssetOptions& options,
                                        const Progress& progress);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <span>

#include <lodestone/core/mesh.h>

#include "gltf/draco_encode.h"
#include "gltf/glb_builder.h"
#include "scene/scene_primitives.h"

namespace lodestone::detail {

/// Rounds a level to its grids, so that it is what decoders get: positions and floats to multiples of the steps,
/// directions to those of the octahedral filter, skin weights such that they still sum to what they did. Morph targets
/// and what has no grid stay.
void round_level(const MeshSource& source, const QuantizationGrids& grids, LevelGeometry& level);

/// Write elements for every wedge, or indices, packed by meshopt. Return the accessor's index. Pre: values are rounded
/// to the grid.
std::size_t add_packed_positions(GlbBuilder& builder, const Mesh& mesh, const QuantizationGrid& grid);
std::size_t add_packed_attribute(GlbBuilder& builder, const Attribute& attribute, const QuantizationGrid& grid);
std::size_t add_packed_indices(GlbBuilder& builder, std::span<const Index> indices, std::size_t point_count);

/// Whether an attribute is one of directions, stored by the bits of its grid alone.
bool is_packed_direction(const Attribute& attribute);

}  // namespace lodestone::detail

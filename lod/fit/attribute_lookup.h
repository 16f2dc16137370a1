#pragma once

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Gives the wedges of a level whose vertices have moved the attributes that the original has where they went, each on
/// its own side of every seam. Vertices whose textures would turn a face over go back to where they were.
///
/// `before` is the level as it was: the same wedges at vertices of the original.
void look_up_attributes(const Mesh& original, const Mesh& before, Mesh& level);

}  // namespace lodestone::detail

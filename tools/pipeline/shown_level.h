#pragma once

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Gives a level a face of each material that it has lost, one of the mesh's own: what shows a level of a stream has
/// something of each primitive, where the stream's faces go. Pre: the level has the mesh's attributes, or no faces.
void keep_every_material(const Mesh& whole, Mesh& level);

}  // namespace lodestone::detail

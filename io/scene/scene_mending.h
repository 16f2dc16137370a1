#pragma once

#include "scene/scene_impl.h"
#include "scene/scene_primitives.h"

namespace lodestone::detail {

/// Gives a coarser level the attributes that glTF asks for where the original's are not so: normals and tangents of
/// length 1, skin weights that sum to 1, each joint once and only with a weight. Else what is off in the original would
/// be off, and complained about, again in every level. What is as it should be stays bit for bit.
void mend_attributes(const MeshSource& source, LevelGeometry& level);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Positions in the fewest digits that read back exactly; vt and vn from float TEXCOORD_0 and NORMAL.
std::vector<std::byte> to_obj(const Mesh& mesh);

/// Binary little-endian. With attributes a point per wedge, else a point per vertex.
std::vector<std::byte> to_ply(const Mesh& mesh);

/// Returns the mesh's float attribute of this name and size, or null.
const Attribute* find_float_attribute(const Mesh& mesh, const char* name, int component_count);

}  // namespace lodestone::detail

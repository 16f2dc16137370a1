#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone::detail {

/// Positions in the fewest digits that read back exactly; vt and vn from float TEXCOORD_0 and NORMAL.
std::vector<std::byte> to_obj(const Mesh& mesh);

/// Binary little-endian. With attributes a point per wedge, else a point per vertex.
std::vector<std::byte> to_ply(const Mesh& mesh);

/// Uncompressed, one primitive per material. A mesh without faces becomes a node without a mesh.
Result<std::vector<std::byte>> to_glb(const Mesh& mesh, const std::string& name);

/// Returns the mesh's float attribute of this name and size, or null.
const Attribute* find_float_attribute(const Mesh& mesh, const char* name, int component_count);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::bench {

/// Returns a mesh as a file of one of the formats that kernels read: "obj", "off", "ply" (binary), "ply-ascii", "stl"
/// (binary), "stl-ascii", "glb". Numbers in text have the fewest digits that read back exactly, which are more than
/// most files have.
std::vector<std::byte> file_bytes(const Mesh& mesh, const std::string& format);

/// Returns the mesh with unit normals and texture coordinates, one of each for every wedge.
Mesh with_attributes(const Mesh& mesh);

}  // namespace lodestone::bench

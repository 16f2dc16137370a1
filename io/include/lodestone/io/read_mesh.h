#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone {

/// A mesh file as read: the assembled mesh and what was changed or left out on the way.
struct MeshFile {
  Mesh mesh;
  AssemblyReport assembly;
  std::vector<std::string> notes;  ///< what the file holds that `mesh` does not, one sentence each
};

/// Reads triangles from OBJ, PLY, STL, glTF or GLB (by content, then by extension), or whatever Assimp knows.
///
/// OBJ coordinates are correctly rounded. A glTF scene is flattened into world space; of a multi-LOD file the finest
/// level is read. Draco, KHR_mesh_quantization and meshopt compression are decoded.
/// Errors: Unreadable, Malformed, LimitExceeded, Unsupported; messages name the file's part and its numbers.
Result<MeshFile> read_mesh(const std::filesystem::path& path);

}  // namespace lodestone

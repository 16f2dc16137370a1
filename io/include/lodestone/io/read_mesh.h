#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/io/material.h>

namespace lodestone {

/// A mesh file as read: the assembled mesh and what was changed or left out on the way.
struct MeshFile {
  Mesh mesh;
  AssemblyReport assembly;
  std::vector<Material> materials;  ///< those that faces name, by their number − 1; none of glTF, which `Scene` keeps
  std::vector<Image> images;        ///< of the materials' textures
  std::vector<std::string> notes;   ///< what the file holds that `mesh` does not, one sentence each
};

/// Reads triangles from OBJ, PLY, STL, OFF, glTF, GLB or a stream (by content, then by extension), or whatever Assimp
/// knows. Of a stream the finest level that it has is read, without materials.
///
/// Coordinates are the correctly rounded floats of what the file says (not promised for Assimp's formats). A glTF scene
/// is flattened into world space; of a multi-LOD file the finest level is read. Draco, KHR_mesh_quantization and
/// meshopt compression are decoded. Texture coordinates follow glTF, v downwards; so do colours: COLOR_0 is linear
/// light, 16 bits where the file has sRGB. Other attributes keep the file's types. Concave polygons become triangles
/// that cover them. OBJ's material libraries and textures are read from beside the file. A face's material is 0 where
/// the file names none, else a number from 1: glTF's material index + 1, elsewhere in order of first use. Errors:
/// Unreadable, Malformed, LimitExceeded, Unsupported; messages name the file's part and its numbers.
Result<MeshFile> read_mesh(const std::filesystem::path& path);

/// Reads the same from memory; `extension` ("obj", "gltf", … or "") decides where the content does not.
/// Files beside it are out of reach: a .gltf may have none, materials of OBJ stay plain. Errors: as above.
Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const std::string& extension);

/// Returns the bytes that have to be loaded to show a file: its own and, of a glTF's, those of the buffers and images
/// beside it, which may be missing. Errors: Unreadable, Malformed.
Result<std::uint64_t> loaded_bytes(const std::filesystem::path& path);

}  // namespace lodestone

#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone {

/// Writes a mesh as .obj, .ply (binary) or .glb (uncompressed), by the extension of `path`.
/// Positions are written so that they read back bit for bit. Attributes are written where the format has a place for
/// them. Errors: Unsupported for another extension, NotWritten.
Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh);

/// Encodes a mesh as `write_mesh` would write it to `path`, and writes nothing. Errors: Unsupported.
Result<std::vector<std::byte>> write_mesh_bytes(const Mesh& mesh, const std::filesystem::path& path);

}  // namespace lodestone

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <lodestone/core/result.h>
#include <lodestone/io/read_mesh.h>

#include "base/files_beside.h"

namespace lodestone::detail {

/// Reads a mesh from memory, files beside it through `fetch`; as `read_mesh`.
Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const std::string& extension,
                                 const FileFetcher& fetch);

/// True for what `read_mesh` takes for glTF: by content, then by extension (lower case, without the dot).
bool is_gltf(std::span<const std::byte> bytes, std::string_view extension);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone::tool {

/// Checks that a heatmap's path has an extension that can be written. Errors: InvalidArgument.
Result<void> check_heatmap_path(const std::filesystem::path& path);

/// Encodes a mesh with vertex colours by error, as .ply or .glb by the extension of `path`; nothing is written.
/// Normals stay, all other attributes go. `upper` is the error of the darkest colour, mesh units.
/// Pre: an error for each vertex. Errors: as write_mesh's.
Result<std::vector<std::byte>> encode_heatmap(const std::filesystem::path& path, const Mesh& mesh,
                                              std::span<const float> errors, double upper);

}  // namespace lodestone::tool

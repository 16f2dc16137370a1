#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone::detail {

/// Uncompressed, one primitive per material. A mesh without faces becomes a node without a mesh.
Result<std::vector<std::byte>> to_glb(const Mesh& mesh, const std::string& name);

}  // namespace lodestone::detail

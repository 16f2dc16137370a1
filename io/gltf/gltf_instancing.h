#pragma once

#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "base/transform.h"
#include "gltf/gltf_document.h"

namespace lodestone::detail {

/// Returns where a node shows its mesh, relative to itself: once, but for EXT_mesh_gpu_instancing.
/// Errors: Malformed; `where` names the node.
Result<std::vector<Transform>> read_copies(const GltfDocument& document, const Json& node, const std::string& where);

}  // namespace lodestone::detail

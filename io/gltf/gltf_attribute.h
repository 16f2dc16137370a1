#pragma once

#include <optional>
#include <string>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// How an attribute may be written to a glTF primitive.
struct GltfSemantic {
  std::string name;                 ///< the member of `attributes`
  bool needs_quantization = false;  ///< only legal with KHR_mesh_quantization
};

/// Returns the semantic an attribute is legal under: its own name, or an application-specific one ("_NAME") where
/// glTF knows the name but not in this type. Nothing for types no vertex attribute may have.
std::optional<GltfSemantic> gltf_semantic(const Attribute& attribute);

/// Whether attributes differ in nothing but their data.
bool same_layout(const Attribute& a, const Attribute& b);

/// Returns glTF's name for vectors of 1 to 4 components.
const char* gltf_type(std::uint8_t component_count);

}  // namespace lodestone::detail

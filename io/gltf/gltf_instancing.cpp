#include "gltf/gltf_instancing.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone::detail {
namespace {

/// Reads one attribute of EXT_mesh_gpu_instancing; empty where it is absent.
Result<std::vector<float>> read_instancing(const GltfDocument& document, const Json& attributes, const char* name,
                                           std::uint8_t components, const std::string& where) {
  if (find_member(attributes, name) == nullptr) return std::vector<float>{};
  LODESTONE_TRY(const std::size_t index, size_member(attributes, name, where));
  LODESTONE_TRY(const AccessorData data, document.accessor(index));
  if (data.component_count != components)
    return fail(ErrorCode::Malformed, text(where, ": ", name, " has ", int{data.component_count}, " components"));
  return to_floats(data);
}

}  // namespace

Result<std::vector<Transform>> read_copies(const GltfDocument& document, const Json& node, const std::string& where) {
  const Json* extension = GltfDocument::extension(node, "EXT_mesh_gpu_instancing");
  const Json* attributes = extension != nullptr ? find_member(*extension, "attributes") : nullptr;
  if (attributes == nullptr) return std::vector<Transform>(1);
  LODESTONE_TRY(const auto moves, read_instancing(document, *attributes, "TRANSLATION", 3, where));
  LODESTONE_TRY(const auto turns, read_instancing(document, *attributes, "ROTATION", 4, where));
  LODESTONE_TRY(const auto scales, read_instancing(document, *attributes, "SCALE", 3, where));
  const std::size_t count = std::max({moves.size() / 3, turns.size() / 4, scales.size() / 3});
  std::vector<Transform> copies(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [i](const std::vector<float>& values, std::size_t size, std::size_t k, double other) {
      return size * i + k < values.size() ? values[size * i + k] : other;
    };
    copies[i] = from_trs({at(moves, 3, 0, 0), at(moves, 3, 1, 0), at(moves, 3, 2, 0)},
                         {at(turns, 4, 0, 0), at(turns, 4, 1, 0), at(turns, 4, 2, 0), at(turns, 4, 3, 1)},
                         {at(scales, 3, 0, 1), at(scales, 3, 1, 1), at(scales, 3, 2, 1)});
  }
  return copies;
}

}  // namespace lodestone::detail

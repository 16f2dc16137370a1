#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <lodestone/core/result.h>

#include "gltf/gltf_document.h"

namespace lodestone::detail {

/// An attribute to get out of Draco data, in the type its glTF accessor declares.
struct DracoRequest {
  std::uint32_t unique_id = 0;
  ComponentType type = ComponentType::Float32;
  std::uint8_t component_count = 3;
  bool normalized = false;
};

struct DracoGeometry {
  std::size_t point_count = 0;
  std::vector<Index> indices;            ///< three per triangle, < point_count
  std::vector<AccessorData> attributes;  ///< one per request, one element per point
};

/// Decodes a Draco mesh (bitstream 2.2, the one of KHR_draco_mesh_compression). `where` names it in messages.
Result<DracoGeometry> decode_draco(std::span<const std::byte> bytes, std::span<const DracoRequest> requests,
                                   std::string_view where);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/mesh.h>

#include "gltf/glb_builder.h"
#include "gltf/gltf_document.h"

namespace lodestone::detail {

/// The faces of one material.
struct FacesOfMaterial {
  Index material = 0;
  std::vector<Index> corner_wedge;  ///< three per face, in the order of the mesh
};

/// Splits a mesh's faces by material, ascending. Empty for a mesh without faces.
std::vector<FacesOfMaterial> split_by_material(const Mesh& mesh);

/// Returns the mesh with only some of its attributes, in the order given.
Mesh with_attributes(const Mesh& mesh, std::span<const Attribute* const> attributes);

/// Returns some faces of a mesh as one of their own, without materials and with only some of its attributes: wedges and
/// vertices in the order in which the faces use them.
Mesh submesh(const Mesh& mesh, std::span<const Index> corner_wedge, std::span<const Attribute* const> attributes);

/// What an order of faces is best for, besides the vertex cache.
enum class FaceOrder { Drawing, Packing };

/// Returns the mesh with faces and wedges in an order that graphics hardware likes: the vertex cache's, then the order
/// of first use. Faces of one material stay together.
Mesh in_hardware_order(const Mesh& mesh, FaceOrder order = FaceOrder::Drawing);

/// Returns packed elements each on a multiple of 4 bytes, as glTF demands of vertex data.
std::vector<std::byte> with_stride(std::span<const std::byte> packed, std::size_t element_bytes, std::size_t stride);

/// The narrowest type that glTF lets indices of so many points have: the largest value of a type is none.
constexpr ComponentType index_type(std::size_t point_count) {
  return point_count <= 0xffff ? ComponentType::UInt16 : ComponentType::UInt32;
}

/// Indices in that type.
struct PackedIndices {
  ComponentType type = ComponentType::UInt32;
  std::vector<std::byte> bytes;
};
PackedIndices pack_indices(std::span<const Index> indices, std::size_t point_count);

/// The box of positions that lie as tightly packed floats x, y, z. Pre: there is at least one.
struct PositionBounds {
  Vec3f low, high;
};
PositionBounds bounds_of(std::span<const std::byte> positions);

/// Write elements for every wedge, or indices, uncompressed. Return the accessor's index.
std::size_t add_positions(GlbBuilder& builder, const Mesh& mesh);
std::size_t add_attribute(GlbBuilder& builder, const Attribute& attribute);
std::size_t add_indices(GlbBuilder& builder, std::span<const Index> indices, std::size_t point_count);

/// Return the accessor of data that is not stored in it: of Draco data. That of positions has min and max.
Json attribute_accessor(const AccessorData& data);
Json position_accessor(const AccessorData& data);

/// Sets min and max as glTF wants them of positions. Pre: as `bounds_of`.
void set_bounds(Json& accessor, std::span<const std::byte> positions);

}  // namespace lodestone::detail

#include "gltf/gltf_mesh_writer.h"

#include <algorithm>
#include <map>
#include <utility>

#include <meshoptimizer.h>

#include <lodestone/core/detail/compaction.h>

#include "base/bytes.h"
#include "gltf/gltf_attribute.h"

namespace lodestone::detail {

std::vector<FacesOfMaterial> split_by_material(const Mesh& mesh) {
  std::map<Index, FacesOfMaterial> groups;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    const Index material = mesh.material_of(face);
    FacesOfMaterial& group = groups[material];
    group.material = material;
    const auto first = mesh.corner_wedge.begin() + 3 * std::size_t{face};
    group.corner_wedge.insert(group.corner_wedge.end(), first, first + 3);
  }
  std::vector<FacesOfMaterial> out;
  for (auto& [material, group] : groups) out.push_back(std::move(group));
  return out;
}

Mesh with_attributes(const Mesh& mesh, std::span<const Attribute* const> attributes) {
  Mesh out{mesh.positions, mesh.wedge_vertex, mesh.corner_wedge, mesh.face_material, {}};
  for (const Attribute* attribute : attributes) out.attributes.push_back(*attribute);
  return out;
}

Mesh submesh(const Mesh& mesh, std::span<const Index> corner_wedge, std::span<const Attribute* const> attributes) {
  CompactedMesh out = compacted(mesh.positions, mesh.wedge_vertex, corner_wedge);
  for (const Attribute* source : attributes) out.mesh.attributes.push_back(pick_elements(*source, out.source_wedge));
  return std::move(out.mesh);
}

Mesh in_hardware_order(const Mesh& mesh, FaceOrder order) {
  std::vector<Index> corner_wedge;
  std::vector<Index> face_material;
  for (const FacesOfMaterial& group : split_by_material(mesh)) {
    std::vector<Index> corners(group.corner_wedge.size());
    const std::size_t count = corners.size(), wedges = mesh.wedge_count();
    if (order == FaceOrder::Packing)
      meshopt_optimizeVertexCacheStrip(corners.data(), group.corner_wedge.data(), count, wedges);
    else
      meshopt_optimizeVertexCache(corners.data(), group.corner_wedge.data(), count, wedges);
    corner_wedge.insert(corner_wedge.end(), corners.begin(), corners.end());
    if (!mesh.face_material.empty()) face_material.insert(face_material.end(), corners.size() / 3, group.material);
  }
  std::vector<const Attribute*> attributes;
  for (const Attribute& attribute : mesh.attributes) attributes.push_back(&attribute);
  Mesh out = submesh(mesh, corner_wedge, attributes);
  out.face_material = std::move(face_material);
  return out;
}

std::vector<std::byte> with_stride(std::span<const std::byte> packed, std::size_t element_bytes, std::size_t stride) {
  const std::size_t count = packed.size() / element_bytes;
  std::vector<std::byte> out(count * stride);
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(packed.begin() + i * element_bytes, element_bytes, out.begin() + i * stride);
  return out;
}

PackedIndices pack_indices(std::span<const Index> indices, std::size_t point_count) {
  const bool narrow = index_type(point_count) == ComponentType::UInt16;
  const std::vector<std::uint16_t> shorts(indices.begin(), narrow ? indices.end() : indices.begin());
  const auto bytes = narrow ? std::as_bytes(std::span(shorts)) : std::as_bytes(indices);
  return {index_type(point_count), {bytes.begin(), bytes.end()}};
}

PositionBounds bounds_of(std::span<const std::byte> positions) {
  Vec3f low = load<Vec3f>(positions, 0), high = low;
  for (std::size_t at = sizeof(Vec3f); at < positions.size(); at += sizeof(Vec3f)) {
    const auto p = load<Vec3f>(positions, at);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high};
}

std::size_t add_positions(GlbBuilder& builder, const Mesh& mesh) {
  const std::vector<Vec3f> positions = pick_entries(mesh.positions, mesh.wedge_vertex);
  const auto bytes = std::as_bytes(std::span(positions));
  Json accessor = {{"bufferView", builder.add_view(bytes, ViewTarget::Vertices, sizeof(Vec3f))},
                   {"componentType", static_cast<int>(ComponentType::Float32)},
                   {"count", positions.size()},
                   {"type", "VEC3"}};
  set_bounds(accessor, bytes);
  return builder.add("accessors", std::move(accessor));
}

std::size_t add_attribute(GlbBuilder& builder, const Attribute& attribute) {
  const std::size_t size = attribute.element_bytes(), stride = padded_to_four(size);
  const std::size_t view = builder.add_view(with_stride(attribute.data, size, stride), ViewTarget::Vertices, stride);
  Json accessor = {{"bufferView", view},
                   {"componentType", static_cast<int>(attribute.type)},
                   {"count", attribute.data.size() / size},
                   {"type", gltf_type(attribute.component_count)}};
  if (attribute.normalized && attribute.type != ComponentType::Float32) accessor["normalized"] = true;
  return builder.add("accessors", std::move(accessor));
}

std::size_t add_indices(GlbBuilder& builder, std::span<const Index> indices, std::size_t point_count) {
  const PackedIndices packed = pack_indices(indices, point_count);
  return builder.add("accessors", {{"bufferView", builder.add_view(packed.bytes, ViewTarget::Indices)},
                                   {"componentType", static_cast<int>(packed.type)},
                                   {"count", indices.size()},
                                   {"type", "SCALAR"}});
}

Json attribute_accessor(const AccessorData& data) {
  Json accessor = {
      {"componentType", static_cast<int>(data.type)}, {"count", data.count}, {"type", gltf_type(data.component_count)}};
  if (data.normalized && data.type != ComponentType::Float32) accessor["normalized"] = true;
  return accessor;
}

Json position_accessor(const AccessorData& data) {
  Json accessor = attribute_accessor(data);
  set_bounds(accessor, data.bytes);
  return accessor;
}

void set_bounds(Json& accessor, std::span<const std::byte> positions) {
  const auto [low, high] = bounds_of(positions);
  accessor["min"] = {of_few_digits(low.x), of_few_digits(low.y), of_few_digits(low.z)};
  accessor["max"] = {of_few_digits(high.x), of_few_digits(high.y), of_few_digits(high.z)};
}

}  // namespace lodestone::detail

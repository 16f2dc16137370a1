#include "gltf_mesh_writer.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <utility>

#include "bytes.h"
#include "gltf_attribute.h"
#include "text.h"

namespace lodestone::detail {
namespace {

/// One element for each wedge, each on a multiple of 4 bytes as glTF demands of vertex data.
std::vector<std::byte> with_stride(std::span<const std::byte> packed, std::size_t element_bytes, std::size_t stride) {
  const std::size_t count = packed.size() / element_bytes;
  std::vector<std::byte> out(count * stride);
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(packed.begin() + i * element_bytes, element_bytes, out.begin() + i * stride);
  return out;
}

std::size_t add_positions(GlbBuilder& builder, const Mesh& mesh) {
  std::vector<Vec3f> positions;
  positions.reserve(mesh.wedge_count());
  for (const Index vertex : mesh.wedge_vertex) positions.push_back(mesh.positions[vertex]);
  const std::size_t view = builder.add_view(std::as_bytes(std::span(positions)), ViewTarget::Vertices, sizeof(Vec3f));
  auto [low, high] = position_bounds(positions);
  return builder.add("accessors", {{"bufferView", view},
                                   {"componentType", static_cast<int>(ComponentType::Float32)},
                                   {"count", positions.size()},
                                   {"type", "VEC3"},
                                   {"min", std::move(low)},
                                   {"max", std::move(high)}});
}

std::size_t add_attribute(GlbBuilder& builder, const Attribute& attribute) {
  const std::size_t size = attribute.element_bytes(), stride = (size + 3) / 4 * 4;
  const std::size_t view = builder.add_view(with_stride(attribute.data, size, stride), ViewTarget::Vertices, stride);
  Json accessor = {{"bufferView", view},
                   {"componentType", static_cast<int>(attribute.type)},
                   {"count", attribute.data.size() / size},
                   {"type", gltf_type(attribute.component_count)}};
  if (attribute.normalized && attribute.type != ComponentType::Float32) accessor["normalized"] = true;
  return builder.add("accessors", std::move(accessor));
}

Json add_vertices(GlbBuilder& builder, const Mesh& mesh) {
  Json attributes = {{"POSITION", add_positions(builder, mesh)}};
  for (const Attribute& attribute : mesh.attributes) {
    const auto semantic = gltf_semantic(attribute);
    if (!semantic) continue;
    attributes[semantic->name] = add_attribute(builder, attribute);
    if (semantic->needs_quantization) builder.require_extension("KHR_mesh_quantization");
  }
  return attributes;
}

/// 16 bits where they suffice; the largest value of a type is not an index.
std::size_t add_indices(GlbBuilder& builder, std::span<const Index> indices, std::size_t point_count) {
  const bool narrow = point_count <= 0xffff;
  const std::vector<std::uint16_t> shorts(indices.begin(), narrow ? indices.end() : indices.begin());
  const auto bytes = narrow ? std::as_bytes(std::span(shorts)) : std::as_bytes(indices);
  const std::size_t view = builder.add_view(bytes, ViewTarget::Indices);
  return builder.add("accessors",
                     {{"bufferView", view},
                      {"componentType", static_cast<int>(narrow ? ComponentType::UInt16 : ComponentType::UInt32)},
                      {"count", indices.size()},
                      {"type", "SCALAR"}});
}

/// Copies the wedges of `mesh` to their new numbers in `out`; ~0 means that no face uses one.
void renumber_wedges(const Mesh& mesh, std::span<const unsigned> new_number, std::size_t used, Mesh& out) {
  out.wedge_vertex.resize(used);
  for (std::size_t wedge = 0; wedge < new_number.size(); ++wedge)
    if (new_number[wedge] != ~0u) out.wedge_vertex[new_number[wedge]] = mesh.wedge_vertex[wedge];
  for (const Attribute& source : mesh.attributes) {
    Attribute a{source.name, source.type, source.component_count, source.normalized, {}};
    const std::size_t size = a.element_bytes();
    a.data.resize(used * size);
    for (std::size_t wedge = 0; wedge < new_number.size(); ++wedge)
      if (new_number[wedge] != ~0u)
        std::copy_n(source.data.begin() + wedge * size, size, a.data.begin() + new_number[wedge] * size);
    out.attributes.push_back(std::move(a));
  }
  for (Index& wedge : out.corner_wedge) wedge = new_number[wedge];
}

}  // namespace

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

MaterialTable::MaterialTable(GlbBuilder& builder, const std::set<Index>& numbers) {
  for (const Index number : numbers)
    if (number != 0)
      index_of_[number] =
          builder.add("materials", {{"name", text("material ", number)},
                                    {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.8}}}});
}

void MaterialTable::assign(Json& primitive, Index number) const {
  if (number != 0) primitive["material"] = index_of_.at(number);
}

std::optional<std::size_t> add_plain_mesh(GlbBuilder& builder, const Mesh& mesh, const std::string& name,
                                          const MaterialTable& materials) {
  if (mesh.face_count() == 0) return std::nullopt;
  const Json attributes = add_vertices(builder, mesh);
  Json primitives = Json::array();
  for (const FacesOfMaterial& group : split_by_material(mesh)) {
    Json primitive = {{"attributes", attributes},
                      {"indices", add_indices(builder, group.corner_wedge, mesh.wedge_count())}};
    materials.assign(primitive, group.material);
    primitives.push_back(std::move(primitive));
  }
  Json object;
  if (!name.empty()) object["name"] = name;
  object["primitives"] = std::move(primitives);
  return builder.add("meshes", std::move(object));
}

Mesh in_hardware_order(const Mesh& mesh) {
  Mesh out;
  out.positions = mesh.positions;
  for (const FacesOfMaterial& group : split_by_material(mesh)) {
    std::vector<unsigned> corners(group.corner_wedge.size());
    meshopt_optimizeVertexCache(corners.data(), group.corner_wedge.data(), corners.size(), mesh.wedge_count());
    out.corner_wedge.insert(out.corner_wedge.end(), corners.begin(), corners.end());
    if (!mesh.face_material.empty())
      out.face_material.insert(out.face_material.end(), corners.size() / 3, group.material);
  }
  std::vector<unsigned> new_number(mesh.wedge_count());
  const std::size_t used = meshopt_optimizeVertexFetchRemap(new_number.data(), out.corner_wedge.data(),
                                                            out.corner_wedge.size(), mesh.wedge_count());
  renumber_wedges(mesh, new_number, used, out);
  return out;
}

std::pair<Json, Json> position_bounds(std::span<const Vec3f> positions) {
  Vec3f low = positions[0], high = positions[0];
  for (const Vec3f& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {Json::array({low.x, low.y, low.z}), Json::array({high.x, high.y, high.z})};
}

}  // namespace lodestone::detail

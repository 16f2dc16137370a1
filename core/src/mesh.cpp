#include <lodestone/core/mesh.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include <lodestone/core/detail/compaction.h>

namespace lodestone {

std::size_t component_bytes(ComponentType type) {
  switch (type) {
    case ComponentType::Int8:
    case ComponentType::UInt8:
      return 1;
    case ComponentType::Int16:
    case ComponentType::UInt16:
      return 2;
    case ComponentType::UInt32:
    case ComponentType::Float32:
      return 4;
  }
  return 0;
}

double largest_component(ComponentType type) {
  switch (type) {
    case ComponentType::Int8:
      return std::numeric_limits<std::int8_t>::max();
    case ComponentType::UInt8:
      return std::numeric_limits<std::uint8_t>::max();
    case ComponentType::Int16:
      return std::numeric_limits<std::int16_t>::max();
    case ComponentType::UInt16:
      return std::numeric_limits<std::uint16_t>::max();
    case ComponentType::UInt32:
      return std::numeric_limits<std::uint32_t>::max();
    case ComponentType::Float32:
      return 1;
  }
  return 1;
}

namespace {

template <class T>
std::vector<float> values_as(const Attribute& attribute) {
  const auto unit = static_cast<float>(attribute.normalized ? largest_component(attribute.type) : 1);
  std::vector<float> values(attribute.data.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, &attribute.data[i * sizeof(T)], sizeof(T));
    values[i] = static_cast<float>(value) / unit;
  }
  return values;
}

}  // namespace

std::vector<float> attribute_values(const Attribute& attribute) {
  switch (attribute.type) {
    case ComponentType::Int8:
      return values_as<std::int8_t>(attribute);
    case ComponentType::UInt8:
      return values_as<std::uint8_t>(attribute);
    case ComponentType::Int16:
      return values_as<std::int16_t>(attribute);
    case ComponentType::UInt16:
      return values_as<std::uint16_t>(attribute);
    case ComponentType::UInt32:
      return values_as<std::uint32_t>(attribute);
    case ComponentType::Float32:
      return values_as<float>(attribute);
  }
  return {};
}

Attribute pick_elements(const Attribute& attribute, std::span<const Index> elements) {
  Attribute picked{attribute.name, attribute.type, attribute.component_count, attribute.normalized, {}};
  const std::size_t bytes = attribute.element_bytes();
  picked.data.resize(bytes * elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i)
    std::memcpy(&picked.data[i * bytes], &attribute.data[elements[i] * bytes], bytes);
  return picked;
}

Vec3 area_vector(const Mesh& mesh, Index face) {
  const Vec3 a = mesh.corner_position(3 * face);
  return cross(mesh.corner_position(3 * face + 1) - a, mesh.corner_position(3 * face + 2) - a);
}

Mesh pick_faces(const Mesh& mesh, std::span<const Index> faces, std::vector<Index>* source_vertex) {
  std::vector<Index> corner_wedge;
  corner_wedge.reserve(3 * faces.size());
  for (const Index face : faces)
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) corner_wedge.push_back(mesh.corner_wedge[corner]);
  detail::CompactedMesh picked = detail::compacted(mesh.positions, mesh.wedge_vertex, corner_wedge);
  if (!mesh.face_material.empty()) picked.mesh.face_material = detail::pick_entries(mesh.face_material, faces);
  for (const Attribute& attribute : mesh.attributes)
    picked.mesh.attributes.push_back(pick_elements(attribute, picked.source_wedge));
  if (source_vertex != nullptr) *source_vertex = std::move(picked.source_vertex);
  return std::move(picked.mesh);
}

Box bounding_box(const Mesh& mesh) {
  if (mesh.face_count() == 0) return {};
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Box box{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    const Vec3 p = mesh.corner_position(corner);
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

double surface_area(const Mesh& mesh) {
  double area = 0;
  for (Index face = 0; face < mesh.face_count(); ++face) area += 0.5 * length(area_vector(mesh, face));
  return area;
}

}  // namespace lodestone

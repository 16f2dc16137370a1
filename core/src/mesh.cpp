#include <lodestone/core/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include <lodestone/core/detail/compaction.h>

namespace lodestone {
namespace {

/// Calls `visit` with a value of the C++ type of a component.
template <class Visit>
auto with_type(ComponentType type, const Visit& visit) {
  switch (type) {
    case ComponentType::Int8:
      return visit(std::int8_t{});
    case ComponentType::UInt8:
      return visit(std::uint8_t{});
    case ComponentType::Int16:
      return visit(std::int16_t{});
    case ComponentType::UInt16:
      return visit(std::uint16_t{});
    case ComponentType::UInt32:
      return visit(std::uint32_t{});
    case ComponentType::Float32:
      break;
  }
  return visit(float{});
}

}  // namespace

std::size_t component_bytes(ComponentType type) {
  return with_type(type, [](auto value) { return sizeof value; });
}

double largest_component(ComponentType type) {
  return with_type(type, [](auto value) {
    using Limits = std::numeric_limits<decltype(value)>;
    return Limits::is_integer ? static_cast<double>(Limits::max()) : 1.0;
  });
}

std::vector<float> component_values(ComponentType type, bool normalized, std::span<const std::byte> data) {
  const auto unit = static_cast<float>(normalized ? largest_component(type) : 1);
  const bool may_fall_below = normalized && type != ComponentType::Float32;
  return with_type(type, [&](auto value) {
    std::vector<float> values(data.size() / sizeof value);
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::memcpy(&value, &data[i * sizeof value], sizeof value);
      values[i] = static_cast<float>(value) / unit;
      if (may_fall_below) values[i] = std::max(values[i], -1.0F);
    }
    return values;
  });
}

void store_component(ComponentType type, bool normalized, double value, std::byte* out) {
  if (normalized) value *= largest_component(type);
  with_type(type, [&](auto stored) {
    using Stored = decltype(stored);
    using Limits = std::numeric_limits<Stored>;
    if (Limits::is_integer)
      value = std::clamp(std::round(value), static_cast<double>(Limits::lowest()), static_cast<double>(Limits::max()));
    stored = static_cast<Stored>(value);
    std::memcpy(out, &stored, sizeof stored);
  });
}

std::vector<float> attribute_values(const Attribute& attribute) {
  return component_values(attribute.type, attribute.normalized, attribute.data);
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

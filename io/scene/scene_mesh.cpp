#include "scene/scene_mesh.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "gltf/gltf_attribute.h"
#include "gltf/gltf_primitive.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kAlwaysAllowedBytes = std::size_t{64} << 20;

/// Splits "TARGET_2:NORMAL"; such a name cannot come from `attributes`, where a primitive's targets are told apart.
MeshColumn target_column(const Attribute& layout) {
  const std::size_t colon = layout.name.find(':');
  const std::string number = layout.name.substr(7, colon - 7);
  return {layout, layout.name.substr(colon + 1), static_cast<std::size_t>(std::stoull(number)), false};
}

std::optional<MeshColumn> column_of(const Attribute& attribute, bool is_target) {
  const Attribute layout{attribute.name, attribute.type, attribute.component_count, attribute.normalized, {}};
  if (is_target) return target_column(layout);
  const auto semantic = gltf_semantic(layout);
  if (!semantic) return std::nullopt;
  return MeshColumn{layout, semantic->name, std::nullopt, semantic->needs_quantization};
}

/// Finds the column of an attribute, or makes it.
std::optional<std::size_t> find_column(std::vector<MeshColumn>& columns, const Attribute& attribute, bool is_target) {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const MeshColumn& column) {
    return column.target.has_value() == is_target && same_layout(column.layout, attribute);
  });
  if (found != columns.end()) return static_cast<std::size_t>(found - columns.begin());
  auto column = column_of(attribute, is_target);
  if (!column) return std::nullopt;
  columns.push_back(std::move(*column));
  return columns.size() - 1;
}

/// Appends the attributes of points from number `first` on; where others lacked them before, they are zero.
void append_columns(const std::vector<Attribute>& attributes, bool are_targets, std::size_t first,
                    SourcePrimitive& described, JoinedMesh& joined_mesh, TriangleSoup& soup) {
  for (const Attribute& attribute : attributes) {
    const auto column = find_column(joined_mesh.source.columns, attribute, are_targets);
    if (!column) {
      joined_mesh.left_out.push_back(attribute.name);
      continue;
    }
    described.columns.push_back(*column);
    soup.attributes.resize(joined_mesh.source.columns.size());
    Attribute& joined = soup.attributes[*column];
    joined.data.resize(first * attribute.element_bytes());
    append_bytes(joined.data, attribute.data);
  }
}

/// Appends a primitive's points and triangles; columns that it lacks are filled up with zeros later.
void append_primitive(const Primitive& primitive, JoinedMesh& joined, TriangleSoup& soup) {
  const std::size_t first = soup.positions.size();
  SourcePrimitive& described = joined.source.primitives[primitive.number];
  soup.positions.insert(soup.positions.end(), primitive.positions.begin(), primitive.positions.end());
  append_columns(primitive.attributes, false, first, described, joined, soup);
  append_columns(primitive.targets, true, first, described, joined, soup);
  std::sort(described.columns.begin(), described.columns.end());
  for (const Index point : primitive.indices) soup.indices.push_back(static_cast<Index>(first + point));
  soup.face_material.insert(soup.face_material.end(), primitive.indices.size() / 3,
                            static_cast<Index>(primitive.number));
}

/// Joined, every point has the attributes of all primitives: many small primitives could ask for any amount.
Result<void> check_size(const GltfDocument& document, std::span<const Primitive> primitives, std::size_t mesh) {
  std::size_t points = 0, bytes_per_point = sizeof(Vec3f);
  std::vector<const Attribute*> layouts;
  for (const Primitive& primitive : primitives) {
    points += primitive.positions.size();
    for (const auto* attributes : {&primitive.attributes, &primitive.targets})
      for (const Attribute& a : *attributes) {
        if (std::any_of(layouts.begin(), layouts.end(), [&](const Attribute* b) { return same_layout(a, *b); }))
          continue;
        layouts.push_back(&a);
        bytes_per_point += a.element_bytes();
      }
  }
  const std::size_t limit = kAlwaysAllowedBytes + 4 * document.expansion_limit();
  if (points <= limit / bytes_per_point && points < kNoIndex) return {};
  return fail(ErrorCode::LimitExceeded, text("mesh ", mesh, ": ", points, " points of ", bytes_per_point,
                                             " bytes are more than can come from this file"));
}

void describe_targets(const Json& json, SourcePrimitive& primitive) {
  const Json* targets = find_member(json, "targets");
  primitive.target_count = targets != nullptr && targets->is_array() ? targets->size() : 0;
}

std::string material_name(const GltfDocument& document, const Json& primitive) {
  const auto index = size_member(primitive, "material", "");
  const auto material = index ? document.element("materials", "material", *index) : fail(ErrorCode::Malformed, "");
  return material ? string_member(**material, "name") : "";
}

}  // namespace

void complete_attributes(const MeshSource& source, TriangleSoup& soup) {
  soup.attributes.resize(source.columns.size());
  for (std::size_t i = 0; i < source.columns.size(); ++i) {
    std::vector<std::byte> data = std::move(soup.attributes[i].data);
    soup.attributes[i] = source.columns[i].layout;
    data.resize(soup.positions.size() * soup.attributes[i].element_bytes());
    soup.attributes[i].data = std::move(data);
  }
  if (source.primitives.size() <= 1) soup.face_material.clear();
}

Result<std::optional<JoinedMesh>> join_primitives(const GltfDocument& document, std::size_t mesh) {
  PrimitiveReader reader(document, PrimitiveContent::Whole);
  LODESTONE_TRY(const std::vector<Primitive> primitives, reader.read_mesh(mesh));
  LODESTONE_CHECK(check_size(document, primitives, mesh));
  LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", mesh));
  const Json& list = (*json)["primitives"];

  JoinedMesh joined;
  joined.source.mesh = mesh;
  joined.source.primitives.resize(list.size());
  TriangleSoup soup;
  for (const Primitive& primitive : primitives) {
    if (primitive.indices.empty()) continue;
    SourcePrimitive& described = joined.source.primitives[primitive.number];
    described.replaced = true;
    describe_targets(list[primitive.number], described);
    joined.mesh.has_targets |= described.target_count > 0;
    append_primitive(primitive, joined, soup);
  }
  if (soup.indices.empty()) return std::optional<JoinedMesh>();
  complete_attributes(joined.source, soup);
  LODESTONE_TRY(AssembledMesh assembled, assemble(soup));
  joined.mesh.name = string_member(*json, "name");
  joined.mesh.mesh = std::move(assembled.mesh);
  joined.mesh.assembly = assembled.report;
  for (const Json& primitive : list) joined.mesh.materials.push_back(material_name(document, primitive));
  return std::optional<JoinedMesh>(std::move(joined));
}

MeshSource source_of(const Mesh& mesh, std::size_t primitive_count) {
  MeshSource source;
  SourcePrimitive primitive{true, {}, 0};
  for (const Attribute& attribute : mesh.attributes)
    if (const auto column = find_column(source.columns, attribute, false)) primitive.columns.push_back(*column);
  source.primitives.assign(primitive_count, primitive);
  return source;
}

}  // namespace lodestone::detail

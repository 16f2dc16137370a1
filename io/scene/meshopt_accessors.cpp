#include "scene/meshopt_accessors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include <lodestone/core/detail/compaction.h>

#include "base/bytes.h"
#include "gltf/gltf_mesh_writer.h"
#include "gltf/meshopt_encode.h"

namespace lodestone::detail {
namespace {

/// Of a grid whose steps are powers of two.
int exponent_of(const QuantizationGrid& grid) { return std::ilogb(grid.step()); }

float rounded(float value, int exponent) {
  return static_cast<float>(std::ldexp(std::nearbyint(std::ldexp(static_cast<double>(value), -exponent)), exponent));
}

bool has_grid(const Attribute& attribute, const QuantizationGrid& grid) {
  return attribute.type == ComponentType::Float32 && !grid.is_exact();
}

Attribute with_values(const Attribute& layout, std::span<const float> values) {
  Attribute out{layout.name, layout.type, layout.component_count, layout.normalized, {}};
  append_bytes(out.data, std::as_bytes(values));
  return out;
}

Attribute rounded(const Attribute& attribute, const QuantizationGrid& grid) {
  std::vector<float> values = attribute_values(attribute);
  if (is_packed_direction(attribute)) {
    const std::size_t components = attribute.component_count;
    values = octahedral_values(octahedral_form(values, components, grid.bits), components, grid.bits);
  } else {
    for (float& value : values) value = rounded(value, exponent_of(grid));
  }
  return with_values(attribute, values);
}

/// Others of that name are an application's own.
bool are_weights(const Attribute& attribute) {
  return attribute.name.starts_with("WEIGHTS_") && attribute.component_count == 4;
}

/// The float columns of skin weights, each with its grid's exponent.
struct WeightColumn {
  std::vector<float> values;
  std::size_t column = 0;
  int exponent = 0;
};

/// What rounding has taken from a wedge's weights, or given, goes to or from the largest of them.
void keep_sum(std::vector<WeightColumn>& columns, std::size_t first, std::size_t count, double sum) {
  float* largest = nullptr;
  double now = 0;
  int exponent = 0;
  for (WeightColumn& column : columns)
    for (std::size_t i = first; i < first + count; ++i) {
      float& value = column.values[i];
      now += static_cast<double>(value);
      if (largest == nullptr || value > *largest) largest = &value, exponent = column.exponent;
    }
  if (largest != nullptr) *largest = rounded(static_cast<float>(static_cast<double>(*largest) + sum - now), exponent);
}

void round_weights(const QuantizationGrids& grids, LevelGeometry& level) {
  std::vector<WeightColumn> columns;
  for (std::size_t c = 0; c < level.columns.size(); ++c)
    if (are_weights(*level.columns[c]) && has_grid(*level.columns[c], grids.attributes[c]))
      columns.push_back({attribute_values(*level.columns[c]), c, exponent_of(grids.attributes[c])});
  if (columns.empty()) return;
  const std::size_t count = level.columns[columns[0].column]->component_count;
  for (std::size_t first = 0; first < columns[0].values.size(); first += count) {
    double sum = 0;
    for (WeightColumn& column : columns)
      for (std::size_t i = first; i < first + count; ++i) {
        sum += static_cast<double>(column.values[i]);
        column.values[i] = rounded(column.values[i], column.exponent);
      }
    keep_sum(columns, first, count, sum);
  }
  for (const WeightColumn& column : columns)
    level.replace_column(column.column, with_values(*level.columns[column.column], column.values));
}

/// Elements as they go into a view, and how an accessor tells them.
struct PackedForm {
  std::vector<std::byte> bytes;
  std::size_t stride = 0;
  MeshoptFilter filter = MeshoptFilter::None;
  AccessorData type;
};

PackedForm form_of(const Attribute& attribute, const QuantizationGrid& grid) {
  const std::size_t size = attribute.element_bytes(), stride = padded_to_four(size),
                    count = attribute.data.size() / size;
  const AccessorData type{attribute.type, attribute.component_count, attribute.normalized, count, {}};
  if (!has_grid(attribute, grid)) return {with_stride(attribute.data, size, stride), stride, MeshoptFilter::None, type};
  const std::span<const float> values = as_floats(attribute.data);
  if (is_packed_direction(attribute))
    return {octahedral_form(values, attribute.component_count, grid.bits), octahedral_stride(grid.bits),
            MeshoptFilter::Octahedral,
            AccessorData{octahedral_type(grid.bits), attribute.component_count, true, count, {}}};
  return {exponential_form(values, exponent_of(grid)), stride, MeshoptFilter::Exponential, type};
}

Json packed_accessor(GlbBuilder& builder, const PackedForm& form) {
  Json accessor = attribute_accessor(form.type);
  accessor["bufferView"] =
      builder.add_packed_view(pack_elements(form.bytes, form.stride, form.filter), ViewTarget::Vertices);
  return accessor;
}

}  // namespace

bool is_packed_direction(const Attribute& attribute) {
  return attribute.type == ComponentType::Float32 && ((attribute.name == "NORMAL" && attribute.component_count == 3) ||
                                                      (attribute.name == "TANGENT" && attribute.component_count == 4));
}

void round_level(const MeshSource& source, const QuantizationGrids& grids, LevelGeometry& level) {
  auto mesh = std::make_unique<Mesh>(with_attributes(*level.mesh, {}));
  if (!grids.position.is_exact()) {
    const int exponent = exponent_of(grids.position);
    for (Vec3f& p : mesh->positions) p = {rounded(p.x, exponent), rounded(p.y, exponent), rounded(p.z, exponent)};
  }
  level.replace_mesh(std::move(mesh));
  round_weights(grids, level);
  for (std::size_t c = 0; c < level.columns.size(); ++c) {
    const Attribute& attribute = *level.columns[c];
    if (source.columns[c].target || are_weights(attribute) || !has_grid(attribute, grids.attributes[c])) continue;
    level.replace_column(c, rounded(attribute, grids.attributes[c]));
  }
}

std::size_t add_packed_positions(GlbBuilder& builder, const Mesh& mesh, const QuantizationGrid& grid) {
  const std::vector<Vec3f> positions = pick_entries(mesh.positions, mesh.wedge_vertex);
  Attribute attribute{"POSITION", ComponentType::Float32, 3, false, {}};
  append_bytes(attribute.data, std::as_bytes(std::span(positions)));
  Json accessor = packed_accessor(builder, form_of(attribute, grid));
  set_bounds(accessor, attribute.data);
  return builder.add("accessors", std::move(accessor));
}

std::size_t add_packed_attribute(GlbBuilder& builder, const Attribute& attribute, const QuantizationGrid& grid) {
  const PackedForm form = form_of(attribute, grid);
  if (form.filter == MeshoptFilter::Octahedral) builder.require_extension("KHR_mesh_quantization");
  Json accessor = packed_accessor(builder, form);
  return builder.add("accessors", std::move(accessor));
}

std::size_t add_packed_indices(GlbBuilder& builder, std::span<const Index> indices, std::size_t point_count) {
  Json accessor = attribute_accessor({index_type(point_count), 1, false, indices.size(), {}});
  accessor["bufferView"] = builder.add_packed_view(pack_triangles(indices, point_count), ViewTarget::Indices);
  return builder.add("accessors", std::move(accessor));
}

}  // namespace lodestone::detail

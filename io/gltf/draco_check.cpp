#include "gltf/draco_check.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

constexpr double kRounding = 1e-5;  // of a sum of floats, relative to what the largest of them could make

/// The sums of one column over all corners, by component.
struct CornerSums {
  std::vector<double> sum, largest;

  CornerSums(std::span<const float> values, std::size_t component_count, std::span<const Index> corners)
      : sum(component_count), largest(component_count) {
    for (const Index corner : corners)
      for (std::size_t c = 0; c < component_count; ++c) {
        const auto value = static_cast<double>(values[corner * component_count + c]);
        sum[c] += value;
        largest[c] = std::max(largest[c], std::abs(value));
      }
  }

  /// Whether no value need have moved farther than `step`.
  bool agrees(const CornerSums& other, std::size_t corner_count, double step) const {
    for (std::size_t c = 0; c < sum.size(); ++c) {
      const double allowed = (step + kRounding * largest[c]) * static_cast<double>(corner_count);
      if (std::isfinite(sum[c]) && !(std::abs(sum[c] - other.sum[c]) <= allowed)) return false;
    }
    return true;
  }
};

std::vector<Index> corner_vertices(const Mesh& mesh) {
  std::vector<Index> vertices(mesh.corner_wedge.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = mesh.corner_vertex(static_cast<Index>(i));
  return vertices;
}

/// Normals are quantised on an octahedron, whose step says nothing of a component.
double step_of(const Attribute& attribute, const QuantizationGrid& grid) {
  if (attribute.type != ComponentType::Float32) return 0;
  return attribute.name == "NORMAL" ? 2 : grid.step();
}

}  // namespace

Result<void> check_decoded(const DracoGeometry& decoded, const Mesh& mesh, const QuantizationGrids& grids) {
  const auto differs = [](const std::string& what) { return fail(ErrorCode::Unsupported, "Draco: " + what); };
  const std::size_t corner_count = mesh.corner_wedge.size();
  if (decoded.indices.size() != corner_count)
    return differs(text("decodes ", decoded.indices.size() / 3, " of ", mesh.face_count(), " faces"));
  const auto decoded_sums = [&](std::size_t column) {
    const AccessorData& data = decoded.attributes[column];
    return CornerSums(to_floats(data), data.component_count, decoded.indices);
  };
  const std::span positions(reinterpret_cast<const float*>(mesh.positions.data()), 3 * mesh.vertex_count());
  if (!CornerSums(positions, 3, corner_vertices(mesh)).agrees(decoded_sums(0), corner_count, grids.position.step()))
    return differs("decodes other positions");
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    const Attribute& a = mesh.attributes[i];
    const CornerSums sums(attribute_values(a), a.component_count, mesh.corner_wedge);
    if (!sums.agrees(decoded_sums(i + 1), corner_count, step_of(a, grids.attributes[i])))
      return differs(text("decodes another ", a.name));
  }
  return {};
}

}  // namespace lodestone::detail

// Morton: A computer oriented geodetic data base and a new technique in file sequencing (IBM, 1966).

#include "spatial_order.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace lodestone::detail {
namespace {

/// Spreads the low 21 bits of `x` to every third bit.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

class MortonCurve {
 public:
  explicit MortonCurve(const Box& box) : low_(box.low) {
    const Vec3 extent = box.high - box.low;
    const double largest = std::max({extent.x, extent.y, extent.z});
    scale_ = largest > 0 ? 2097151.0 / largest : 0;
  }
  std::uint64_t code(const Vec3& p) const {
    const auto cell = [&](double v) { return static_cast<std::uint64_t>(std::clamp(v * scale_, 0.0, 2097151.0)); };
    const Vec3 d = p - low_;
    return spread_bits(cell(d.x)) | spread_bits(cell(d.y)) << 1 | spread_bits(cell(d.z)) << 2;
  }

 private:
  Vec3 low_;
  double scale_;
};

using Coded = std::pair<std::uint64_t, Index>;  // ties go to the lower number

/// The faces along the curve, by centroid.
std::vector<Index> face_order(const Mesh& mesh) {
  const MortonCurve curve(bounding_box(mesh));
  std::vector<Coded> coded(mesh.face_count());
  for (Index f = 0; f < coded.size(); ++f) {
    const Vec3 sum = mesh.corner_position(3 * f) + mesh.corner_position(3 * f + 1) + mesh.corner_position(3 * f + 2);
    coded[f] = {curve.code(sum * (1.0 / 3)), f};
  }
  std::sort(coded.begin(), coded.end());
  std::vector<Index> order;
  order.reserve(coded.size());
  for (const Coded& c : coded) order.push_back(c.second);
  return order;
}

void copy_attributes(const Mesh& mesh, const std::vector<Index>& source, Mesh& sorted) {
  for (const Attribute& attribute : mesh.attributes) {
    Attribute& copy = sorted.attributes.emplace_back(
        Attribute{attribute.name, attribute.type, attribute.component_count, attribute.normalized, {}});
    const std::size_t bytes = attribute.element_bytes();
    copy.data.resize(bytes * source.size());
    for (std::size_t w = 0; w < source.size(); ++w)
      std::memcpy(&copy.data[w * bytes], &attribute.data[source[w] * bytes], bytes);
  }
}

}  // namespace

Mesh in_spatial_order(const Mesh& mesh, std::vector<Index>& source_vertex) {
  Mesh sorted;
  source_vertex.clear();
  std::vector<Index> vertex_of(mesh.vertex_count(), kNoIndex);
  std::vector<Index> wedge_of(mesh.wedge_count(), kNoIndex);
  std::vector<Index> source_wedge;
  sorted.corner_wedge.reserve(mesh.corner_wedge.size());
  // Vertices and wedges follow the faces, in order of first use.
  for (const Index face : face_order(mesh)) {
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const Index wedge = mesh.corner_wedge[corner];
      Index& vertex = vertex_of[mesh.wedge_vertex[wedge]];
      if (vertex == kNoIndex) {
        vertex = static_cast<Index>(sorted.positions.size());
        sorted.positions.push_back(mesh.positions[mesh.wedge_vertex[wedge]]);
        source_vertex.push_back(mesh.wedge_vertex[wedge]);
      }
      if (wedge_of[wedge] == kNoIndex) {
        wedge_of[wedge] = static_cast<Index>(sorted.wedge_vertex.size());
        sorted.wedge_vertex.push_back(vertex);
        source_wedge.push_back(wedge);
      }
      sorted.corner_wedge.push_back(wedge_of[wedge]);
    }
    if (!mesh.face_material.empty()) sorted.face_material.push_back(mesh.face_material[face]);
  }
  copy_attributes(mesh, source_wedge, sorted);
  return sorted;
}

}  // namespace lodestone::detail

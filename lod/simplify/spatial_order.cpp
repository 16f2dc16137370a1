#include "simplify/spatial_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "distance/morton_curve.h"

namespace lodestone::detail {
namespace {

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

}  // namespace

Mesh in_spatial_order(const Mesh& mesh, std::vector<Index>& source_vertex) {
  return pick_faces(mesh, face_order(mesh), &source_vertex);
}

}  // namespace lodestone::detail

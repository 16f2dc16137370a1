// Kim, Hong, Kim: Mesh simplification with discrete curvature error metric. Angles by atan2, which keeps its accuracy
// where faces are nearly flat or folded.

#include <lodestone/core/curvature.h>

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

Vec3 position(const Mesh& mesh, const Connectivity& connectivity, Index corner) {
  return Vec3(mesh.positions[connectivity.vertex(corner)]);
}

/// The normal of a corner's face, twice the face's area long.
Vec3 corner_normal(const Mesh& mesh, const Connectivity& connectivity, Index corner) {
  const Vec3 p = position(mesh, connectivity, corner);
  return cross(position(mesh, connectivity, next_corner(corner)) - p,
               position(mesh, connectivity, previous_corner(corner)) - p);
}

/// The dihedral share of the edge facing `corner`: ¼ |e|·|β|; 0 at a border and at a crease.
double edge_share(const Mesh& mesh, const Connectivity& connectivity, Index corner) {
  const Index across = connectivity.opposite(corner);
  if (across == kNoIndex || connectivity.is_crease(corner)) return 0;
  const double angle =
      angle_between(corner_normal(mesh, connectivity, corner), corner_normal(mesh, connectivity, across));
  return 0.25 * angle *
         length(position(mesh, connectivity, previous_corner(corner)) -
                position(mesh, connectivity, next_corner(corner)));
}

}  // namespace

double principal_curvature(const VertexCurvature& curvature) {
  if (curvature.gaussian >= 0) return 2 * curvature.mean;
  return 2 * std::sqrt(curvature.mean * curvature.mean - curvature.gaussian * curvature.area);
}

VertexCurvature vertex_curvature(const Mesh& mesh, const Connectivity& connectivity, Index vertex) {
  VertexCurvature result;
  const Index start = connectivity.corner_at(vertex);
  if (start == kNoIndex) return result;
  Index corner = start;
  do {
    const Vec3 p = position(mesh, connectivity, corner);
    const Vec3 a = position(mesh, connectivity, next_corner(corner)) - p;
    const Vec3 b = position(mesh, connectivity, previous_corner(corner)) - p;
    result.gaussian -= angle_between(a, b);
    result.area += length(cross(a, b)) / 6;
    result.mean += edge_share(mesh, connectivity, previous_corner(corner));
    corner = connectivity.swing_left(corner);
  } while (corner != kNoIndex && corner != start);
  result.gaussian += corner == kNoIndex ? std::numbers::pi : 2 * std::numbers::pi;
  return result;
}

std::vector<VertexCurvature> vertex_curvatures(const Mesh& mesh, const Connectivity& connectivity) {
  std::vector<VertexCurvature> curvatures(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) curvatures[v] = vertex_curvature(mesh, connectivity, v);
  return curvatures;
}

}  // namespace lodestone

// Kim, Hong, Kim: Mesh simplification with discrete curvature error metric. Angles by atan2, which keeps its accuracy
// where faces are nearly flat or folded.

#include <lodestone/core/curvature.h>

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

void add_corner(const Mesh& mesh, const Connectivity& connectivity, Index corner,
                std::vector<VertexCurvature>& curvatures) {
  const Vec3 p = mesh.corner_position(corner);
  const Vec3 a = mesh.corner_position(next_corner(corner)) - p;
  const Vec3 b = mesh.corner_position(previous_corner(corner)) - p;
  VertexCurvature& at = curvatures[connectivity.vertex(corner)];
  at.gaussian -= angle_between(a, b);
  at.area += length(cross(a, b)) / 6;
}

Vec3 face_normal(const Mesh& mesh, Index corner) {
  const Vec3 p = mesh.corner_position(corner);
  return cross(mesh.corner_position(next_corner(corner)) - p, mesh.corner_position(previous_corner(corner)) - p);
}

void add_edge(const Mesh& mesh, const Connectivity& connectivity, Index corner,
              std::vector<VertexCurvature>& curvatures) {
  const Index across = connectivity.opposite(corner);
  if (across == kNoIndex || across < corner) return;  // each edge once
  const Index a = next_corner(corner);
  const Index b = previous_corner(corner);
  const double angle = angle_between(face_normal(mesh, corner), face_normal(mesh, across));
  const double share = 0.25 * length(mesh.corner_position(b) - mesh.corner_position(a)) * angle;
  curvatures[connectivity.vertex(a)].mean += share;
  curvatures[connectivity.vertex(b)].mean += share;
}

}  // namespace

double principal_curvature(const VertexCurvature& curvature) {
  if (curvature.gaussian >= 0) return 2 * curvature.mean;
  return 2 * std::sqrt(curvature.mean * curvature.mean - curvature.gaussian * curvature.area);
}

std::vector<VertexCurvature> vertex_curvatures(const Mesh& mesh, const Connectivity& connectivity) {
  std::vector<VertexCurvature> curvatures(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (!connectivity.has_vertex(v)) continue;
    const bool closed = connectivity.swing_right(connectivity.corner_at(v)) != kNoIndex;
    curvatures[v].gaussian = closed ? 2 * std::numbers::pi : std::numbers::pi;
  }
  for (Index c = 0; c < 3 * connectivity.face_slot_count(); ++c) {
    if (!connectivity.has_face(face_of_corner(c))) continue;
    add_corner(mesh, connectivity, c, curvatures);
    add_edge(mesh, connectivity, c, curvatures);
  }
  return curvatures;
}

}  // namespace lodestone

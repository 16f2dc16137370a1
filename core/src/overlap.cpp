#include "overlap.h"

#include <algorithm>

namespace lodestone::detail {

double overlap(const Mesh& mesh, Index a, Index b) {
  // Both from one end of the edge: then faces that coincide have equal numbers, to the last bit.
  const auto low_end = [&](Index c) { return std::min(mesh.corner_vertex(c), mesh.corner_vertex(next_corner(c))); };
  const auto high_end = [&](Index c) { return std::max(mesh.corner_vertex(c), mesh.corner_vertex(next_corner(c))); };
  const Vec3 from(mesh.positions[low_end(a)]);
  const Vec3 along = Vec3(mesh.positions[high_end(a)]) - from;
  const Vec3 normal_a = cross(along, mesh.corner_position(previous_corner(a)) - from);
  const Vec3 normal_b = cross(along, mesh.corner_position(previous_corner(b)) - from);
  const double lengths = length(normal_a) * length(normal_b);
  return lengths > 0 ? dot(normal_a, normal_b) / lengths : 0;
}

}  // namespace lodestone::detail

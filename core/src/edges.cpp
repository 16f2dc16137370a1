#include "edges.h"

#include <algorithm>

namespace lodestone::detail {

std::vector<HalfEdge> sorted_edges(const Mesh& mesh) {
  std::vector<HalfEdge> edges(mesh.corner_wedge.size());
  for (Index c = 0; c < edges.size(); ++c) {
    const std::uint64_t a = mesh.corner_vertex(c);
    const std::uint64_t b = mesh.corner_vertex(next_corner(c));
    edges[c] = {a < b ? a << 32 | b : b << 32 | a, c, a < b};
  }
  std::sort(edges.begin(), edges.end(),
            [](const HalfEdge& a, const HalfEdge& b) { return a.key != b.key ? a.key < b.key : a.corner < b.corner; });
  return edges;
}

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

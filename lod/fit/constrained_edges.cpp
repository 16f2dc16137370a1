#include "fit/constrained_edges.h"

#include <algorithm>

#include <lodestone/core/assemble.h>
#include <lodestone/core/detail/edges.h>

namespace lodestone::detail {
namespace {

/// The corner that faces the edge.
Index facing(const HalfEdge& half) { return previous_corner(half.corner); }

bool is_free(const Mesh& mesh, Index a, Index b) {
  const auto& wedge = mesh.corner_wedge;
  return wedge[next_corner(a)] == wedge[previous_corner(b)] && wedge[previous_corner(a)] == wedge[next_corner(b)] &&
         mesh.material_of(face_of_corner(a)) == mesh.material_of(face_of_corner(b));
}

/// Pairs each face on one side of an edge with a neighbour on the other. Leaves the edge as it is where there are no
/// two sides, or some face has no neighbour: then it is a line of some sheet.
void pair_corners(const Mesh& mesh, Edge halves, MeshEdge& edge) {
  std::vector<Index> left, right;
  const auto side = [&](Index corner) { return mesh.corner_vertex(corner); };
  for (const HalfEdge& half : halves)
    (side(facing(half)) == side(facing(halves[0])) ? left : right).push_back(facing(half));
  const bool two_sides = std::all_of(right.begin(), right.end(), [&](Index c) { return side(c) == side(right[0]); });
  if (left.size() != right.size() || !two_sides) return;
  std::vector<std::array<Index, 2>> pairs;
  for (const Index corner : left) {
    const auto found = std::find_if(right.begin(), right.end(), [&](Index c) { return is_free(mesh, corner, c); });
    if (found == right.end()) return;
    pairs.push_back({corner, *found});
    right.erase(found);
  }
  edge.constrained = false;
  edge.corners = pairs[0];
  edge.layers.assign(pairs.begin() + 1, pairs.end());
}

}  // namespace

std::vector<MeshEdge> list_edges(const Mesh& mesh) {
  const std::vector<HalfEdge> halves = sorted_edges(mesh);
  std::vector<MeshEdge> edges;
  for_each_edge(halves, [&](Edge half) {
    MeshEdge& edge = edges.emplace_back();
    edge.vertices = {half[0].low(), half[0].high()};
    edge.constrained = true;
    const Index a = facing(half.front());
    const Index b = facing(half.back());
    if (half.size() == 2 && mesh.corner_vertex(a) != mesh.corner_vertex(b) && is_free(mesh, a, b)) {
      edge.constrained = false;
      edge.corners = {a, b};
    } else if (half.size() > 2 && half.size() <= kMostFacesAtEdge) {
      pair_corners(mesh, half, edge);
    }
  });
  return edges;
}

}  // namespace lodestone::detail

#include "fit/constrained_edges.h"

#include <algorithm>
#include <span>
#include <utility>

#include <lodestone/core/assemble.h>

namespace lodestone::detail {
namespace {

struct HalfEdge {
  std::array<Index, 2> vertices;  // the smaller one first
  Index corner;                   // faces the edge
};

bool is_free(const Mesh& mesh, Index a, Index b) {
  const auto& wedge = mesh.corner_wedge;
  return wedge[next_corner(a)] == wedge[previous_corner(b)] && wedge[previous_corner(a)] == wedge[next_corner(b)] &&
         mesh.material_of(face_of_corner(a)) == mesh.material_of(face_of_corner(b));
}

/// Pairs each face on one side of an edge with a neighbour on the other. Leaves the edge as it is where there are no
/// two sides, or some face has no neighbour: then it is a line of some sheet.
void pair_corners(const Mesh& mesh, std::span<const HalfEdge> halves, MeshEdge& edge) {
  std::vector<Index> left, right;
  const auto side = [&](Index corner) { return mesh.corner_vertex(corner); };
  for (const HalfEdge& half : halves)
    (side(half.corner) == side(halves[0].corner) ? left : right).push_back(half.corner);
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
  std::vector<HalfEdge> halves(mesh.corner_wedge.size());
  for (Index c = 0; c < halves.size(); ++c) {
    const Index a = mesh.corner_vertex(next_corner(c));
    const Index b = mesh.corner_vertex(previous_corner(c));
    halves[c] = {{std::min(a, b), std::max(a, b)}, c};
  }
  std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.corner < b.corner;
  });
  std::vector<MeshEdge> edges;
  for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
    while (j < halves.size() && halves[j].vertices == halves[i].vertices) ++j;
    MeshEdge& edge = edges.emplace_back();
    edge.vertices = halves[i].vertices;
    edge.constrained = true;
    const auto [a, b] = std::pair(halves[i].corner, halves[j - 1].corner);
    if (j - i == 2 && mesh.corner_vertex(a) != mesh.corner_vertex(b) && is_free(mesh, a, b)) {
      edge.constrained = false;
      edge.corners = {a, b};
    } else if (j - i > 2 && j - i <= kMostFacesAtEdge) {
      pair_corners(mesh, std::span(halves).subspan(i, j - i), edge);
    }
  }
  return edges;
}

}  // namespace lodestone::detail

#include "constrained_edges.h"

#include <algorithm>

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
    edge.constrained = j - i != 2 || !is_free(mesh, halves[i].corner, halves[i + 1].corner);
    if (!edge.constrained) edge.corners = {halves[i].corner, halves[i + 1].corner};
  }
  return edges;
}

}  // namespace lodestone::detail

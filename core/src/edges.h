#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

// Faces lie on one another at an edge where the cosine of the angle between them is larger.
inline constexpr double kLayered = 0.99;

/// A face's edge, named by the corner that it leaves.
struct HalfEdge {
  std::uint64_t key;  ///< both vertices, the smaller one in the high half
  Index corner;
  bool forward;  ///< from the smaller to the larger vertex
};

/// All faces' halves of an edge.
using Edge = std::span<const HalfEdge>;

/// Returns the halves of all edges, those of an edge together, in the order of their corners.
std::vector<HalfEdge> sorted_edges(const Mesh& mesh);

/// Calls `visit(edge)` for every edge; pre: `halves` are as sorted_edges returns them.
template <class Visit>
void for_each_edge(std::span<const HalfEdge> halves, const Visit& visit) {
  for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
    while (j < halves.size() && halves[j].key == halves[i].key) ++j;
    visit(halves.subspan(i, j - i));
  }
}

/// Returns how two faces meet at an edge, named by a corner that it leaves in each: the cosine of the angle between
/// them, −1 where they lie flat, 1 where one lies on the other. Which way they wind does not matter.
double overlap(const Mesh& mesh, Index a, Index b);

}  // namespace lodestone::detail

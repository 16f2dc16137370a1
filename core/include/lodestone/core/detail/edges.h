#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Names an edge by its ends, whichever comes first: the smaller one stands in the high half.
constexpr std::uint64_t edge_key(Index a, Index b) {
  return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
}

/// A face's edge, named by the corner that it leaves.
struct HalfEdge {
  HalfEdge() = default;
  HalfEdge(Index from, Index to, Index left) : key(edge_key(from, to)), corner(left), forward(from < to) {}

  Index low() const { return static_cast<Index>(key >> 32); }
  Index high() const { return static_cast<Index>(key); }
  bool is_loop() const { return low() == high(); }  ///< of a broken face, that names one end twice

  std::uint64_t key;
  Index corner;
  bool forward;  ///< from the smaller to the larger end
};

/// All faces' halves of an edge.
using Edge = std::span<const HalfEdge>;

/// Puts the halves of an edge together, edges in the order of their keys, and each one's halves in that of their
/// corners.
void sort_edges(std::vector<HalfEdge>& halves);

/// Returns the halves of all edges of triangles, sorted as above: `ends` has the number of what each corner stands at.
std::vector<HalfEdge> sorted_edges(std::span<const Index> ends);

/// The same, where `vertex_of(corner)` names the ends. These may be vertices, sites or wedges.
template <class VertexOf>
std::vector<HalfEdge> sorted_edges(std::size_t corner_count, const VertexOf& vertex_of) {
  std::vector<Index> ends(corner_count);
  for (Index c = 0; c < corner_count; ++c) ends[c] = vertex_of(c);
  return sorted_edges(ends);
}

inline std::vector<HalfEdge> sorted_edges(const Mesh& mesh) {
  return sorted_edges(mesh.corner_wedge.size(), [&](Index corner) { return mesh.corner_vertex(corner); });
}

/// Calls `visit(edge)` for every edge; pre: `halves` are sorted.
template <class Visit>
void for_each_edge(std::span<const HalfEdge> halves, const Visit& visit) {
  for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
    while (j < halves.size() && halves[j].key == halves[i].key) ++j;
    visit(halves.subspan(i, j - i));
  }
}

}  // namespace lodestone::detail

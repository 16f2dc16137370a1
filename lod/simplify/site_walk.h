#pragma once

#include <lodestone/core/connectivity.h>

namespace lodestone::detail {

/// Calls `visit(copy, corner, left)` for the corners at a vertex and at its copies, until one is true; `left` is the
/// next corner counter-clockwise, kNoIndex at a border. Returns whether one was true.
template <class Visit>
bool any_corner(const Connectivity& mesh, Index vertex, const Visit& visit) {
  for (Index copy = vertex;;) {
    const Index start = mesh.corner_at(copy);
    for (Index corner = start; corner != kNoIndex;) {
      const Index left = mesh.swing_left(corner);
      if (visit(copy, corner, left)) return true;
      corner = left == start ? kNoIndex : left;
    }
    copy = mesh.next_copy(copy);
    if (copy == vertex) return false;
  }
}

/// Calls `visit(copy, neighbour)` for each edge at a vertex and at its copies.
template <class Visit>
void for_each_neighbour(const Connectivity& mesh, Index vertex, const Visit& visit) {
  any_corner(mesh, vertex, [&](Index copy, Index corner, Index left) {
    visit(copy, mesh.vertex(next_corner(corner)));
    // At a border no other corner sees the last edge.
    if (left == kNoIndex) visit(copy, mesh.vertex(previous_corner(corner)));
    return false;
  });
}

/// Whether a face joins three sites in this order, in any sheet; `at_first` is a vertex at the first of them.
inline bool has_face(const Connectivity& mesh, Index at_first, Index second, Index third) {
  return any_corner(mesh, at_first, [&](Index, Index corner, Index) {
    return mesh.site(mesh.vertex(next_corner(corner))) == second &&
           mesh.site(mesh.vertex(previous_corner(corner))) == third;
  });
}

}  // namespace lodestone::detail

#include "simplify/locks.h"

#include <algorithm>

#include <lodestone/core/detail/edges.h>

namespace lodestone::detail {
namespace {

/// Whether an edge between sites has one face only, or several that lie on one another.
bool is_border(const Connectivity& mesh, Edge edge) {
  const auto third = [&](const HalfEdge& half) { return mesh.site(mesh.vertex(previous_corner(half.corner))); };
  return std::all_of(edge.begin(), edge.end(), [&](const HalfEdge& half) {
    return mesh.opposite(previous_corner(half.corner)) == kNoIndex && third(half) == third(edge.front());
  });
}

/// Locks the sites of borders. They are looked for among sites: where sheets were cut apart an edge of one has others
/// beside it.
void lock_borders(const Connectivity& mesh, std::vector<std::uint8_t>& locked) {
  const std::vector<HalfEdge> halves =
      sorted_edges(3 * mesh.face_slot_count(), [&](Index corner) { return mesh.site(mesh.vertex(corner)); });
  for_each_edge(halves, [&](Edge edge) {
    if (is_border(mesh, edge)) locked[edge.front().low()] = locked[edge.front().high()] = 1;
  });
}

}  // namespace

std::vector<std::uint8_t> find_locked(const Connectivity& connectivity, const SimplifyOptions& options) {
  std::vector<std::uint8_t> locked(connectivity.vertex_count(), 0);
  if (options.lock_border) lock_borders(connectivity, locked);
  for (Index v = 0; v < options.importance.size(); ++v)
    if (options.importance[v] >= kLockingImportance) locked[connectivity.site(v)] = 1;
  if (std::find(locked.begin(), locked.end(), 1) == locked.end()) return {};
  for (Index v = 0; v < locked.size(); ++v) locked[v] = locked[connectivity.site(v)];
  return locked;
}

}  // namespace lodestone::detail

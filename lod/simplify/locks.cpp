#include "simplify/locks.h"

#include <algorithm>
#include <utility>

namespace lodestone::detail {
namespace {

using Edge = std::pair<Index, Index>;  // sites, the smaller one first

Edge edge_facing(const Connectivity& mesh, Index corner) {
  return std::minmax({mesh.site(mesh.vertex(next_corner(corner))), mesh.site(mesh.vertex(previous_corner(corner)))});
}

/// Locks the sites of edges that have one face only, or several that lie on one another. Where sheets were cut apart an
/// edge of one has others beside it.
void lock_borders(const Connectivity& mesh, std::vector<std::uint8_t>& locked) {
  std::vector<std::pair<Edge, Index>> open;  // and the third site of the face
  for (Index c = 0; c < 3 * mesh.face_slot_count(); ++c)
    if (mesh.opposite(c) == kNoIndex) open.emplace_back(edge_facing(mesh, c), mesh.site(mesh.vertex(c)));
  std::sort(open.begin(), open.end());
  open.erase(std::unique(open.begin(), open.end()), open.end());
  const auto is_open = [&](const Edge& edge) {
    const auto found = std::lower_bound(open.begin(), open.end(), std::pair(edge, Index{0}));
    return found != open.end() && found->first == edge;
  };
  std::vector<Edge> joined;
  for (Index c = 0; c < 3 * mesh.face_slot_count(); ++c)
    if (mesh.opposite(c) != kNoIndex && is_open(edge_facing(mesh, c))) joined.push_back(edge_facing(mesh, c));
  std::sort(joined.begin(), joined.end());
  for (std::size_t i = 0, j = 0; i < open.size(); i = j) {
    while (j < open.size() && open[j].first == open[i].first) ++j;
    const Edge& edge = open[i].first;
    if (j - i > 1 || std::binary_search(joined.begin(), joined.end(), edge)) continue;
    locked[edge.first] = locked[edge.second] = 1;
  }
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

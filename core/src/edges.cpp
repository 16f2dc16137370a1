#include <lodestone/core/detail/edges.h>

#include <algorithm>

namespace lodestone::detail {

void sort_edges(std::vector<HalfEdge>& halves) {
  std::sort(halves.begin(), halves.end(),
            [](const HalfEdge& a, const HalfEdge& b) { return a.key != b.key ? a.key < b.key : a.corner < b.corner; });
}

}  // namespace lodestone::detail

#include <lodestone/core/detail/edges.h>

#include <algorithm>
#include <utility>

namespace lodestone::detail {

// Buckets by the smaller end, in linear time; what is left to sort is the few edges of one vertex.
void sort_edges(std::vector<HalfEdge>& halves) {
  Index largest = 0;
  for (const HalfEdge& half : halves) largest = std::max(largest, half.low());
  std::vector<Index> end(halves.empty() ? 0 : std::size_t{largest} + 1, 0);
  for (const HalfEdge& half : halves) ++end[half.low()];
  Index sum = 0;
  for (Index& e : end) e = sum += e;
  std::vector<HalfEdge> sorted(halves.size());
  std::vector<Index> begin = end;  // filling from the back turns the ends into the beginnings
  for (std::size_t i = halves.size(); i-- > 0;) sorted[--begin[halves[i].low()]] = halves[i];
  const auto earlier = [](const HalfEdge& a, const HalfEdge& b) {
    return a.key != b.key ? a.key < b.key : a.corner < b.corner;
  };
  for (std::size_t b = 0; b < end.size(); ++b) std::sort(sorted.data() + begin[b], sorted.data() + end[b], earlier);
  halves = std::move(sorted);
}

}  // namespace lodestone::detail

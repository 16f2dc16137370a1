#include <lodestone/core/detail/edges.h>

#include <algorithm>
#include <utility>

namespace lodestone::detail {
namespace {

// Where the smaller ends are numbered so sparsely, a bucket for each number costs more than comparisons do.
constexpr std::size_t kMostBuckets = 4;  // for a half

bool is_earlier(const HalfEdge& a, const HalfEdge& b) { return a.key != b.key ? a.key < b.key : a.corner < b.corner; }

}  // namespace

// Buckets by the smaller end, in linear time; what is left to sort is the few edges of one vertex.
void sort_edges(std::vector<HalfEdge>& halves) {
  std::size_t bucket_count = 0;
  for (const HalfEdge& half : halves) bucket_count = std::max(bucket_count, std::size_t{half.low()} + 1);
  if (bucket_count > kMostBuckets * halves.size()) return std::sort(halves.begin(), halves.end(), is_earlier);
  std::vector<Index> end(bucket_count, 0);
  for (const HalfEdge& half : halves) ++end[half.low()];
  Index sum = 0;
  for (Index& e : end) e = sum += e;
  std::vector<HalfEdge> sorted(halves.size());
  std::vector<Index> begin = end;  // filling from the back turns the ends into the beginnings
  for (std::size_t i = halves.size(); i-- > 0;) sorted[--begin[halves[i].low()]] = halves[i];
  for (std::size_t b = 0; b < bucket_count; ++b)
    std::sort(sorted.data() + begin[b], sorted.data() + end[b], is_earlier);
  halves = std::move(sorted);
}

}  // namespace lodestone::detail

#include <lodestone/core/detail/edges.h>

#include <algorithm>
#include <numeric>

namespace lodestone::detail {
namespace {

// Where ends are numbered so sparsely, a bucket for each number costs more than comparisons do.
constexpr std::size_t kMostBuckets = 4;  // for a half

/// Sorts halves by the larger end, then by the smaller one, in linear time and without a comparison: what is equal
/// stays in its order. Pre: ends are below `bucket_count`.
std::vector<HalfEdge> sorted_by_buckets(std::span<const Index> ends, std::size_t bucket_count) {
  std::vector<Index> next_low(bucket_count, 0), next_high(bucket_count, 0);
  const auto for_each_half = [&](const auto& visit) {  // visit(from, to, corner)
    for (std::size_t c = 0; c < ends.size(); c += 3) {
      visit(ends[c], ends[c + 1], c);
      visit(ends[c + 1], ends[c + 2], c + 1);
      visit(ends[c + 2], ends[c], c + 2);
    }
  };
  for_each_half([&](Index from, Index to, std::size_t) {
    ++next_low[std::min(from, to)];
    ++next_high[std::max(from, to)];
  });
  // How many each bucket holds becomes where it begins.
  for (std::vector<Index>* next : {&next_low, &next_high})
    std::exclusive_scan(next->begin(), next->end(), next->begin(), Index{0});
  std::vector<Index> by_high(ends.size());
  for_each_half([&](Index from, Index to, std::size_t corner) {
    by_high[next_high[std::max(from, to)]++] = static_cast<Index>(corner);
  });
  std::vector<HalfEdge> sorted(ends.size());
  for (const Index c : by_high) {
    const Index from = ends[c], to = ends[next_corner(c)];
    sorted[next_low[std::min(from, to)]++] = HalfEdge(from, to, c);
  }
  return sorted;
}

}  // namespace

void sort_edges(std::vector<HalfEdge>& halves) {
  std::sort(halves.begin(), halves.end(),
            [](const HalfEdge& a, const HalfEdge& b) { return a.key != b.key ? a.key < b.key : a.corner < b.corner; });
}

std::vector<HalfEdge> sorted_edges(std::span<const Index> ends) {
  std::size_t bucket_count = 0;
  for (const Index end : ends) bucket_count = std::max(bucket_count, std::size_t{end} + 1);
  if (bucket_count <= kMostBuckets * ends.size()) return sorted_by_buckets(ends, bucket_count);
  std::vector<HalfEdge> halves;
  halves.reserve(ends.size());
  for (Index c = 0; c < ends.size(); ++c) halves.emplace_back(ends[c], ends[next_corner(c)], c);
  sort_edges(halves);
  return halves;
}

}  // namespace lodestone::detail

// An independent set of nearly the greatest size: the vertex of fewest free neighbours goes next, since it takes the
// fewest from others. That grows tight patterns from where it began, which the stream's walk then foresees; picked by
// cost alone, a set of the same kind has a fifth fewer vertices and costs half a bit more for each. But what is dear
// had better wait for a later round: the dearest of all waits like one with six free neighbours more. Source:
// Halldorsson, Radhakrishnan: Greed is good: approximating independent sets in sparse and bounded-degree graphs (1997).

#include "simplify/dense_round.h"

#include <algorithm>
#include <functional>

#include "simplify/site_walk.h"

namespace lodestone::detail {
namespace {

constexpr int kTaken = -1;
constexpr float kDearest = 6;  // what the highest cost counts for, in free neighbours

template <class Visit>
void for_each_other_site(const Connectivity& mesh, Index vertex, const Visit& visit) {
  for_each_neighbour(mesh, vertex, [&](Index, Index neighbour) {
    if (const Index site = mesh.site(neighbour); site != vertex) visit(site);
  });
}

}  // namespace

/// Takes a pick's neighbours out, and tells theirs.
void DenseRound::mark_taken(const Connectivity& mesh, Index vertex) {
  free_[vertex] = kTaken;
  ring_.clear();
  for_each_other_site(mesh, vertex, [&](Index site) {
    if (free_[site] == kTaken) return;
    free_[site] = kTaken;
    ring_.push_back(site);
  });
}

const std::vector<Index>& DenseRound::pick(const Connectivity& mesh, std::span<const Index> candidates,
                                           std::span<const float> cost) {
  picks_.clear();
  heap_.clear();
  free_.assign(cost.size(), kTaken);
  for (const Index v : candidates) free_[v] = 0;
  for (const Index v : candidates)
    for_each_other_site(mesh, v, [&](Index site) { free_[v] += free_[site] == kTaken ? 0 : 1; });
  float highest = 0;
  for (const Index v : candidates) highest = std::max(highest, cost[v]);
  const float per_cost = highest > 0 ? kDearest / highest : 0;
  const auto rank = [&](Index v) { return static_cast<float>(free_[v]) + per_cost * cost[v]; };
  const auto entry = [&](Index v) { return std::pair(rank(v), v); };
  for (const Index v : candidates) heap_.push_back(entry(v));
  std::make_heap(heap_.begin(), heap_.end(), std::greater<>());
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const auto [rank_then, vertex] = heap_.back();
    heap_.pop_back();
    if (free_[vertex] == kTaken || rank_then != rank(vertex)) continue;  // out, or in again with fewer
    picks_.push_back(vertex);
    mark_taken(mesh, vertex);
    for (const Index taken : ring_)
      for_each_other_site(mesh, taken, [&](Index site) {
        if (free_[site] <= 0) return;
        --free_[site];
        heap_.push_back(entry(site));
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
      });
  }
  return picks_;
}

}  // namespace lodestone::detail

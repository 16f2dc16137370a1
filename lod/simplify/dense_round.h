#pragma once

#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/connectivity.h>

namespace lodestone::detail {

/// Chooses the vertices of a round for a small stream: many, no two of them neighbours.
class DenseRound {
 public:
  /// Picks among candidates; `cost` is by vertex, finite, 0 or more: what costs less is preferred. The picks are in the
  /// order in which they were made, and no further candidate is free of neighbours among them.
  const std::vector<Index>& pick(const Connectivity& mesh, std::span<const Index> candidates,
                                 std::span<const float> cost);

 private:
  void mark_taken(const Connectivity& mesh, Index vertex);

  std::vector<Index> picks_;
  std::vector<int> free_;  // by vertex: its neighbours that may still be picked; kTaken where it may not
  std::vector<Index> ring_;
  std::vector<std::pair<float, Index>> heap_;
};

}  // namespace lodestone::detail

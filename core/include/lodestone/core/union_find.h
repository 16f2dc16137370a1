#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone {

/// Disjoint sets of the numbers 0 … count − 1; a set is named by its least member.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  /// Returns the name of the set that `i` is in.
  Index find(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Makes one set of those that `a` and `b` are in.
  void join(Index a, Index b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace lodestone

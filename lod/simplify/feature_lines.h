#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/ids.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// The memory of borders and other constrained lines: the vertices removed from them, by the edge that replaced them.
class FeatureLines {
 public:
  /// The removed vertices that the edge between `a` and `b` stands for.
  const std::vector<Index>& removed_between(Index a, Index b) const {
    static const std::vector<Index> none;
    const auto found = removed_.find(edge_key(a, b));
    return found == removed_.end() ? none : found->second;
  }
  /// Replaces the edges from `vertex` to `target` and to each of `others` by edges from `target` to each of the others.
  void collapse(Index vertex, Index target, std::span<const Index> others) {
    std::vector<Index> with_target = take(vertex, target);
    for (const Index other : others) {
      std::vector<Index> joined = take(vertex, other);
      joined.push_back(vertex);
      joined.insert(joined.end(), with_target.begin(), with_target.end());
      with_target.clear();  // one line carries them on
      std::vector<Index>& there = removed_[edge_key(target, other)];
      there.insert(there.end(), joined.begin(), joined.end());
    }
  }

 private:
  std::vector<Index> take(Index a, Index b) {
    const auto node = removed_.extract(edge_key(a, b));
    return node.empty() ? std::vector<Index>{} : std::move(node.mapped());
  }
  std::unordered_map<std::uint64_t, std::vector<Index>> removed_;
};

}  // namespace lodestone::detail

#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// The memory of borders and other constrained lines: the vertices removed from them, by the edge that replaced them.
class FeatureLines {
 public:
  /// The removed vertices that the edge between `a` and `b` stands for.
  const std::vector<Index>& removed_between(Index a, Index b) const {
    static const std::vector<Index> none;
    const auto found = removed_.find(key(a, b));
    return found == removed_.end() ? none : found->second;
  }
  /// Replaces the edges a–vertex and vertex–b by the edge a–b.
  void merge(Index a, Index vertex, Index b) {
    std::vector<Index> joined = take(a, vertex);
    const std::vector<Index> second = take(vertex, b);
    joined.push_back(vertex);
    joined.insert(joined.end(), second.begin(), second.end());
    removed_[key(a, b)] = std::move(joined);
  }

 private:
  static std::uint64_t key(Index a, Index b) { return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a; }
  std::vector<Index> take(Index a, Index b) {
    const auto node = removed_.extract(key(a, b));
    return node.empty() ? std::vector<Index>{} : std::move(node.mapped());
  }
  std::unordered_map<std::uint64_t, std::vector<Index>> removed_;
};

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <vector>

namespace lodestone::detail {

/// How the nodes of a tree lie in one array, level by level from the lowest up: child i of a level's node n is node, or
/// leaf, width·n + i of the level below.
struct TreeLevels {
  std::vector<std::size_t> begin;  ///< the first node of each level
  std::size_t node_count = 0;      ///< of all levels
};

/// Pre: there is a leaf.
inline TreeLevels tree_levels(std::size_t leaf_count, std::size_t width) {
  TreeLevels levels;
  for (std::size_t count = leaf_count; levels.begin.empty() || count > 1;) {
    count = (count + width - 1) / width;
    levels.begin.push_back(levels.node_count);
    levels.node_count += count;
  }
  return levels;
}

}  // namespace lodestone::detail

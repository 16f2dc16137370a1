#pragma once

#include <span>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// The wedges of a level: those of a vertex stand together, vertices in the order of their numbers.
class WedgeTable {
 public:
  std::size_t size() const { return vertex_.size(); }
  std::size_t vertex_count() const { return begin_.size(); }
  Index vertex(Index wedge) const { return vertex_[wedge]; }
  std::span<const Index> vertices() const { return vertex_; }
  Index begin(Index vertex) const { return begin_[vertex]; }
  Index end(Index vertex) const {
    return vertex + 1 < begin_.size() ? begin_[vertex + 1] : static_cast<Index>(vertex_.size());
  }
  Index count(Index vertex) const { return end(vertex) - begin(vertex); }

  void add_vertex() { begin_.push_back(static_cast<Index>(vertex_.size())); }
  /// Adds a wedge of the last vertex.
  Index add_wedge() {
    vertex_.push_back(static_cast<Index>(begin_.size() - 1));
    return static_cast<Index>(vertex_.size() - 1);
  }

 private:
  std::vector<Index> begin_;   // by vertex
  std::vector<Index> vertex_;  // by wedge
};

}  // namespace lodestone::detail

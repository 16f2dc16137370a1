#pragma once

#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// Numbers sorted into groups, such as the wedges of each vertex.
class Grouping {
 public:
  Grouping() = default;

  /// Sorts 0 … count − 1 into groups: `group_of(i)`, below `group_count`, names that of i.
  template <class GroupOf>
  Grouping(std::size_t group_count, std::size_t count, const GroupOf& group_of)
      : begin_(group_count + 1, 0), members_(count) {
    for (Index i = 0; i < count; ++i) ++begin_[group_of(i)];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    // Filling from the back turns the ends into the beginnings.
    for (auto i = static_cast<Index>(count); i-- > 0;) members_[--begin_[group_of(i)]] = i;
  }

  bool empty() const { return members_.empty(); }

  /// A group's members, ascending.
  std::span<const Index> operator[](Index group) const {
    return std::span(members_).subspan(begin_[group], begin_[group + 1] - begin_[group]);
  }

 private:
  std::vector<Index> begin_;  // by group, and the end of the last
  std::vector<Index> members_;
};

}  // namespace lodestone::detail

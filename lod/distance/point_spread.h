#pragma once

#include <array>

#include <lodestone/core/detail/symmetric3.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// How points are spread about their mean.
struct PointSpread {
  double count = 0;
  Vec3 mean;
  Symmetric3 squares;  ///< the sum over the points of the outer product of their difference from the mean

  void add(const PointSpread& other);

  /// Returns three directions at right angles to each other: that in which the points reach farthest, and across it
  /// the one in which they reach farther and the one in which they reach less far.
  std::array<Vec3, 3> principal_axes() const;
};

}  // namespace lodestone::detail

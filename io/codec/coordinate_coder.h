#pragma once

#include <optional>

#include "codec/bit_coder.h"
#include "codec/fixed_point.h"
#include "codec/number_coder.h"
#include "codec/ring.h"

namespace lodestone::detail {

/// How wrong a prediction was: sixteenths of the logarithm of its error's two parts, along the ring's normal and across
/// it.
struct Miss {
  int normal = 0;
  int tangent = 0;
};

/// Adds up how wrong predictions were.
class MissSum {
 public:
  void add(const Miss& miss) {
    normal_ += miss.normal;
    tangent_ += miss.tangent;
    ++count_;
  }
  int count() const { return count_; }
  /// None of none.
  std::optional<Miss> mean() const {
    if (count_ == 0) return std::nullopt;
    return Miss{normal_ / count_, tangent_ / count_};
  }

 private:
  int normal_ = 0, tangent_ = 0, count_ = 0;
};

/// How wrong a prediction was, over the ring's radius. `residual`: sixteenths of a step.
Miss miss_of(const Vec3i& residual, const Ring& ring);

/// Codes points whose error is taken for normally distributed, of one size along a ring's normal and another, shaped
/// like the ring, across it.
class CoordinateCoder {
 public:
  struct Expected {
    Vec3i point;                 ///< sixteenths of a step of the grid
    Miss size;                   ///< of the error, over sixteenths of a step
    int hint = 0;                ///< how far out the vertex is, 0 … 3: whatever else may tell of its distribution
    std::optional<Miss> around;  ///< how wrong predictions around were, over the ring's radius
  };

  /// Codes a point whose coordinates are multiples of 2^`shift`; those steps are what is coded.
  void code(BitCoder& coder, const Ring& ring, const Expected& expected, int shift, Vec3i& position);

 private:
  NumberCoder numbers_;
};

}  // namespace lodestone::detail

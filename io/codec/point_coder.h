#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/coordinate_coder.h"
#include "codec/fixed_point.h"
#include "codec/number_coder.h"
#include "codec/online_fit.h"
#include "codec/patch_mesh.h"
#include "codec/ring.h"
#include "codec/shift_fit.h"

namespace lodestone::detail {

/// Codes where new vertices lie on a grid, each from the ring around it.
class PointCoder {
 public:
  PointCoder();

  /// The next vertex is one of the base mesh, or has no ring.
  void add_base();
  void add_loose();
  /// Codes the next vertex: `position` is what a writer has, and a reader gets, a multiple of 2^`step`.
  void code(BitCoder& coder, const Ring& ring, bool closed, int step, Vec3i& position);
  /// Learns from the vertex that was coded last.
  void learn(const Vec3i& position, const Ring& ring, bool closed);

 private:
  static constexpr int kSizes = 4;   // of rings, told apart where positions are predicted
  static constexpr int kTraits = 9;  // of a ring, from which the size of errors is predicted
  using Traits = OnlineFit<kTraits>;

  struct Prediction {
    Vec3i point;
    Miss size;  // expected, sixteenths of the logarithm in sixteenths of a step
    Traits::Features normal_traits{}, tangent_traits{};
  };

  void find_misses(const Ring& ring);
  void predict(const Ring& ring, bool closed);
  void predict_size(const Ring& ring, const ShiftFit<Ring::kPulls>& shift);
  static std::size_t size_class(const Ring& ring, bool closed);

  CoordinateCoder coordinates_;
  std::vector<ShiftFit<Ring::kPulls>> shifts_;  // by class of ring size
  Traits normal_size_, tangent_size_;

  std::vector<Miss> misses_;  // by vertex, over the ring's radius
  std::size_t base_count_ = 0;

  // Of the vertex at hand.
  Miss around_;  // mean of those around
  bool has_misses_ = false;
  Prediction prediction_;
};

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/coordinate_coder.h"
#include "codec/fixed_point.h"
#include "codec/online_fit.h"
#include "codec/ring.h"
#include "codec/shift_fit.h"

namespace lodestone::detail {

/// Codes where vertices of a level go that its rounds move, each from where it lies and the ring around it.
class MoveCoder {
 public:
  MoveCoder();

  /// From now on none of so many vertices has moved.
  void start(std::size_t vertex_count);
  /// Codes where a vertex goes that lies at `from`, a multiple of 2^`from_step`: a multiple of 2^`step`.
  void code(BitCoder& coder, const Ring& ring, bool closed, const Vec3i& from, int from_step, int step,
            Vec3i& position);
  /// Learns from the move that was coded last.
  void learn(Index vertex, const Vec3i& position, const Ring& ring);

 private:
  static constexpr int kPulls = 4;
  static constexpr int kTraits = 6;
  using Traits = OnlineFit<kTraits>;

  void find_misses(const Ring& ring);

  CoordinateCoder coordinates_;
  ShiftFit<kPulls> shift_;
  Traits normal_size_, tangent_size_;
  std::vector<std::optional<Miss>> misses_;  // by vertex that has moved, over the ring's radius
  std::vector<Vec3i> went_;                  // by vertex: how far, sixteenths

  // Of the vertex at hand.
  Vec3i start_, point_;  // where it lies, and where it is expected; sixteenths
  std::optional<Miss> around_;
  Vec3i went_around_;  // mean of those that have moved
  Traits::Features traits_{};
};

}  // namespace lodestone::detail

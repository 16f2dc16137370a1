#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "codec/fixed_point.h"
#include "codec/online_fit.h"
#include "codec/ring.h"

namespace lodestone::detail {

/// Predicts how far from a point a vertex lies, as a weighted sum of pulls: with weights of their own along the ring's
/// normal and across it, both learnt. Lengths are over the ring's radius, 256 its length.
template <int N>
class ShiftFit {
 public:
  using Fit = OnlineFit<N>;
  using Weights = std::array<std::int32_t, N>;

  ShiftFit(const Weights& normal, const Weights& tangent, std::int64_t trust)
      : normal_fit_(normal, trust), tangent_fit_(tangent, trust) {}

  /// Predicts the shift, in sixteenths of a step as the pulls are.
  Vec3i predict(const std::array<Vec3i, N>& pulls, const Ring& ring) {
    const Vec3i& n = ring.normal;
    for (std::size_t i = 0; i < N; ++i) {
      const Vec3i pull = scaled(pulls[i], ring.over_radius);
      normal_[i] = along(pull, n);
      const Vec3i rest = pull - times(n, normal_[i]);
      for (int c = 0; c < 3; ++c) tangent_[static_cast<std::size_t>(c)][i] = rest[c];
    }
    Vec3i shift = times(n, normal_fit_.predict(normal_));
    for (int c = 0; c < 3; ++c) shift[c] += tangent_fit_.predict(tangent_[static_cast<std::size_t>(c)]);
    return {shift.x * ring.radius >> kRadiusBits, shift.y * ring.radius >> kRadiusBits,
            shift.z * ring.radius >> kRadiusBits};
  }

  /// Learns what the last shift was, in sixteenths of a step.
  void learn(const Vec3i& went, const Ring& ring) {
    const Vec3i& n = ring.normal;
    const Vec3i shift = scaled(went, ring.over_radius);
    const std::int64_t lift = along(shift, n);
    const Vec3i slide = shift - times(n, lift);
    normal_fit_.add(normal_, lift);
    normal_fit_.end_sample();
    for (int c = 0; c < 3; ++c) tangent_fit_.add(tangent_[static_cast<std::size_t>(c)], slide[c]);
    tangent_fit_.end_sample();
  }

  /// The pulls along the ring's normal, and across it by coordinate, of the last prediction.
  const typename Fit::Features& normal() const { return normal_; }
  const std::array<typename Fit::Features, 3>& tangent() const { return tangent_; }

 private:
  Fit normal_fit_, tangent_fit_;
  typename Fit::Features normal_{};
  std::array<typename Fit::Features, 3> tangent_{};
};

}  // namespace lodestone::detail

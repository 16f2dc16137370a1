// Positions are predicted from the ring by a few estimates of where its middle lies, with weights learnt from what has
// been coded, for the direction of the ring's normal and across it; what is added to the mean is close to the thin
// plate's solution (Kobbelt, Campagna, Vorsatz, Seidel: Interactive multi-resolution modeling on arbitrary meshes,
// 1998) where the mesh is even. The error is taken for normally distributed, of one size along the normal and another,
// shaped like the ring, across it, both learnt as well. Coordinates are coded one by one, each by its distribution
// given those before it: nothing is rotated, so nothing is rounded.

#include "codec/point_coder.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace lodestone::detail {
namespace {

// Until something is learnt: sixteenths of logarithms over the radius.
constexpr int kUsualNormalMiss = -48;
constexpr int kUsualTangentMiss = -32;

}  // namespace

PointCoder::PointCoder()
    : shifts_(kSizes, ShiftFit<Ring::kPulls>({-600, 0, 0, 1200}, {-800, 0, 0, 0}, 1 << 17)),
      normal_size_({0, kHalfWeight, kQuarterWeight, kQuarterWeight}, 1 << 14),
      tangent_size_({0, kHalfWeight, 0, kHalfWeight}, 1 << 14) {}

void PointCoder::add_base() {
  misses_.emplace_back();
  base_count_ = misses_.size();
}

void PointCoder::add_loose() { misses_.push_back({kUsualNormalMiss, kUsualTangentMiss}); }

std::size_t PointCoder::size_class(const Ring& ring, bool closed) {
  return closed ? static_cast<std::size_t>(std::clamp(ring.size() - 4, 0, kSizes - 1)) : 0;
}

/// How well vertices around were predicted, of earlier rounds and of this one.
void PointCoder::find_misses(const Ring& ring) {
  MissSum sum;
  const auto add = [&](Index vertex) {
    if (vertex >= base_count_ && vertex < misses_.size()) sum.add(misses_[vertex]);
  };
  for (const Index corner : ring.corners()) add(corner);
  for (const Index vertex : ring.beyond()) add(vertex);
  has_misses_ = sum.count() > 0;
  around_ = sum.mean().value_or(Miss{kUsualNormalMiss, kUsualTangentMiss});
}

void PointCoder::predict(const Ring& ring, bool closed) {
  ShiftFit<Ring::kPulls>& shift = shifts_[size_class(ring, closed)];
  prediction_.point = ring.mean + shift.predict(ring.pulls, ring);
  predict_size(ring, shift);
}

void PointCoder::predict_size(const Ring& ring, const ShiftFit<Ring::kPulls>& shift) {
  const auto across = [&](std::size_t pull) {
    std::int64_t sum = 0;
    for (const auto& coordinate : shift.tangent()) sum += std::abs(coordinate[pull]);
    return sum;
  };
  const int log_one = 64;
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring.radius));
  prediction_.normal_traits = {log_one,
                               around_.normal,
                               log_of(shift.normal()[0]) - log_one,
                               around_.tangent,
                               log_one - log_radius,  // a step of the grid
                               log_of(across(0)) - log_one,
                               ring.log_least - log_radius,
                               ring.log_edge - log_radius,
                               ring.log_beyond - log_radius};
  prediction_.tangent_traits = prediction_.normal_traits;
  prediction_.tangent_traits[2] = log_of(across(2) + std::abs(shift.normal()[2])) - log_one;
  const auto size = [&](const Traits& fit, const Traits::Features& traits) {
    return static_cast<int>(std::clamp<std::int64_t>(log_radius + fit.predict(traits), 16, 16 * 20));
  };
  prediction_.size = {size(normal_size_, prediction_.normal_traits), size(tangent_size_, prediction_.tangent_traits)};
}

void PointCoder::learn(const Vec3i& position, const Ring& ring, bool closed) {
  shifts_[size_class(ring, closed)].learn(position * 16 - ring.mean, ring);
  const Miss miss = miss_of(position * 16 - prediction_.point, ring);
  misses_.push_back(miss);
  normal_size_.add(prediction_.normal_traits, miss.normal);
  normal_size_.end_sample();
  tangent_size_.add(prediction_.tangent_traits, miss.tangent);
  tangent_size_.end_sample();
}

void PointCoder::code(BitCoder& coder, const Ring& ring, bool closed, int step, Vec3i& position) {
  find_misses(ring);
  predict(ring, closed);
  CoordinateCoder::Expected expected = {prediction_.point, prediction_.size, std::clamp(ring.size() - 3, 0, 3), {}};
  if (has_misses_) expected.around = around_;
  coordinates_.code(coder, ring, expected, step, position);
}

}  // namespace lodestone::detail

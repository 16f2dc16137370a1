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

PointCoder::PointCoder(int grid_bits)
    : grid_bits_(grid_bits),
      shifts_(kSizes, ShiftFit<Ring::kPulls>({-600, 0, 0, 1200}, {-800, 0, 0, 0}, 1 << 17)),
      normal_size_({0, kHalfWeight, kQuarterWeight, kQuarterWeight}, 1 << 14),
      tangent_size_({0, kHalfWeight, 0, kHalfWeight}, 1 << 14) {}

bool PointCoder::code_base(BitCoder& coder, Vec3i& position) {
  misses_.emplace_back();
  base_count_ = misses_.size();
  const std::int64_t half = std::int64_t{16} << (grid_bits_ - 1 - shift_);
  NumberCoder::Guess guess;
  guess.value = half;
  guess.scale = half / 4;
  for (int c = 0; c < 3; ++c)
    position[c] = base_.code(coder, position[c] >> shift_, guess) * (std::int64_t{1} << shift_);
  return is_on_grid(position, grid_bits_);
}

bool PointCoder::code_loose(BitCoder& coder, const Vec3i& guess, Vec3i& position) {
  misses_.push_back({kUsualNormalMiss, kUsualTangentMiss});
  NumberCoder::Guess likely;
  likely.scale = std::max<std::int64_t>(std::int64_t{16} << (grid_bits_ - 5) >> shift_, 1);
  for (int c = 0; c < 3; ++c) {
    likely.value = guess[c] * 16 >> shift_;
    position[c] = loose_.code(coder, position[c] >> shift_, likely) * (std::int64_t{1} << shift_);
  }
  return is_on_grid(position, grid_bits_);
}

void PointCoder::start_round(const PatchMesh& mesh, std::span<const Vec3i> positions) {
  look_at_normals(
      mesh, positions, mesh.vertex_count(), [&](Index half) { return mesh.from(half); }, normals_);
}

Vec3i PointCoder::guess(const PatchMesh& mesh, std::span<const Index> star, bool closed,
                        std::span<const Vec3i> positions) {
  const Vec3i first = positions[mesh.from(3 * star.front() + 1)];
  if (!closed) return divide(first + positions[mesh.to(3 * star.back() + 1)], 2);
  Vec3i sum;
  for (const Index face : star) sum = sum + positions[mesh.from(3 * face + 1)];
  return divide(sum, static_cast<std::int64_t>(star.size()));
}

std::size_t PointCoder::size_class(bool closed) const {
  return closed ? static_cast<std::size_t>(std::clamp(ring_.size() - 4, 0, kSizes - 1)) : 0;
}

/// How well vertices around were predicted, of earlier rounds and of this one.
void PointCoder::find_misses() {
  Miss sum;
  int count = 0;
  const auto add = [&](Index vertex) {
    if (vertex < base_count_ || vertex >= misses_.size()) return;
    sum.normal += misses_[vertex].normal;
    sum.tangent += misses_[vertex].tangent;
    ++count;
  };
  for (const Index corner : ring_.corners()) add(corner);
  for (const Index vertex : ring_.beyond()) add(vertex);
  has_misses_ = count > 0;
  around_ = has_misses_ ? Miss{sum.normal / count, sum.tangent / count} : Miss{kUsualNormalMiss, kUsualTangentMiss};
}

void PointCoder::predict(bool closed) {
  ShiftFit<Ring::kPulls>& shift = shifts_[size_class(closed)];
  prediction_.point = ring_.mean + shift.predict(ring_.pulls, ring_);
  predict_size(shift);
}

void PointCoder::predict_size(const ShiftFit<Ring::kPulls>& shift) {
  const auto across = [&](std::size_t pull) {
    std::int64_t sum = 0;
    for (const auto& coordinate : shift.tangent()) sum += std::abs(coordinate[pull]);
    return sum;
  };
  const int log_one = 64;
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring_.radius));
  prediction_.normal_traits = {log_one,
                               around_.normal,
                               log_of(shift.normal()[0]) - log_one,
                               around_.tangent,
                               log_one - log_radius,  // a step of the grid
                               log_of(across(0)) - log_one,
                               ring_.log_least - log_radius,
                               ring_.log_edge - log_radius,
                               ring_.log_beyond - log_radius};
  prediction_.tangent_traits = prediction_.normal_traits;
  prediction_.tangent_traits[2] = log_of(across(2) + std::abs(shift.normal()[2])) - log_one;
  const auto size = [&](const Traits& fit, const Traits::Features& traits) {
    return static_cast<int>(std::clamp<std::int64_t>(log_radius + fit.predict(traits), 16, 16 * 20));
  };
  prediction_.size = {size(normal_size_, prediction_.normal_traits), size(tangent_size_, prediction_.tangent_traits)};
}

void PointCoder::learn(const Vec3i& position, bool closed) {
  shifts_[size_class(closed)].learn(position * 16 - ring_.mean, ring_);
  const Miss miss = miss_of(position * 16 - prediction_.point, ring_);
  misses_.push_back(miss);
  normal_size_.add(prediction_.normal_traits, miss.normal);
  normal_size_.end_sample();
  tangent_size_.add(prediction_.tangent_traits, miss.tangent);
  tangent_size_.end_sample();
}

bool PointCoder::code(BitCoder& coder, const PatchMesh& mesh, std::span<const Index> star, bool closed,
                      std::span<const Vec3i> positions, Vec3i& position) {
  outer_.clear();
  for (const Index face : star) outer_.push_back(3 * face + 1);
  ring_.look(mesh, outer_, closed, positions, normals_);
  find_misses();
  predict(closed);
  CoordinateCoder::Expected expected = {prediction_.point, prediction_.size, std::clamp(ring_.size() - 3, 0, 3), {}};
  if (has_misses_) expected.around = around_;
  coordinates_.code(coder, ring_, expected, shift_, position);
  if (!is_on_grid(position, grid_bits_)) return false;
  learn(position, closed);
  return true;
}

}  // namespace lodestone::detail

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

constexpr std::int64_t kOne = 256;  // what a ring's radius is in features
constexpr std::int64_t kLeastVariance = 1 << 10;
constexpr std::int64_t kMostRatio = std::int64_t{1} << 32;
constexpr std::int64_t kMostResidual = std::int64_t{1} << 26;
constexpr std::int64_t kRoundness = 20;  // / 256: how much of the spread does not follow the ring's shape

// Until something is learnt: sixteenths of logarithms over the radius.
constexpr int kUsualNormalMiss = -48;
constexpr int kUsualTangentMiss = -32;

constexpr int kHalf = 1 << (OnlineFit<1>::kFraction - 1), kQuarter = kHalf / 2;

Vec3i over_radius(const Vec3i& v, std::int64_t radius) { return v * kOne / radius; }

/// A normal distribution of three coordinates, taken apart: each one's mean and variance given those before it.
struct Coordinates {
  std::array<int, 3> order = {0, 1, 2};
  std::array<std::int64_t, 3> variance{};  // kRatioBits, as the ratios
  std::int64_t second_of_first = 0, third_of_first = 0, third_of_second = 0;
};

std::int64_t product(std::int64_t x, std::int64_t ratio) { return x * ratio >> kRatioBits; }

std::int64_t ratio_of(std::int64_t x, std::int64_t y) {
  return std::clamp(x * (std::int64_t{1} << kRatioBits) / y, -kMostRatio, kMostRatio);
}

/// `normal_variance`: over that across the normal. The coordinate that is steepest comes last.
Coordinates take_apart(const Ring& ring, std::int64_t normal_variance) {
  const Vec3i& n = ring.normal;
  const auto covariance = [&](int i, int j) {
    const std::int64_t normal = n[i] * n[j] >> (2 * kUnitBits - kRatioBits);
    const std::int64_t across = (i == j ? std::int64_t{1} << kRatioBits : 0) - normal;
    return product(normal, normal_variance) + ((across * kRoundness + ring.spread[i][j] * (kOne - kRoundness)) >> 8);
  };
  Coordinates c;
  std::stable_sort(c.order.begin(), c.order.end(), [&](int i, int j) { return std::abs(n[i]) < std::abs(n[j]); });
  const auto [x, y, z] = c.order;
  const std::int64_t xy = covariance(x, y), xz = covariance(x, z);
  c.variance[0] = std::max(covariance(x, x), kLeastVariance);
  c.second_of_first = ratio_of(xy, c.variance[0]);
  c.third_of_first = ratio_of(xz, c.variance[0]);
  c.variance[1] = std::max(covariance(y, y) - product(xy, c.second_of_first), kLeastVariance);
  const std::int64_t yz = covariance(y, z) - product(xz, c.second_of_first);
  c.third_of_second = ratio_of(yz, c.variance[1]);
  c.variance[2] =
      std::max(covariance(z, z) - product(xz, c.third_of_first) - product(yz, c.third_of_second), kLeastVariance);
  return c;
}

}  // namespace

PointCoder::PointCoder(int grid_bits)
    : grid_bits_(grid_bits),
      normal_pulls_(kSizes, Pulls({-600, 0, 0, 1200}, 1 << 17)),
      tangent_pulls_(kSizes, Pulls({-800, 0, 0, 0}, 1 << 17)),
      normal_size_({0, kHalf, kQuarter, kQuarter}, 1 << 14),
      tangent_size_({0, kHalf, 0, kHalf}, 1 << 14) {}

bool PointCoder::is_on_grid(const Vec3i& position) const {
  const std::int64_t end = std::int64_t{1} << grid_bits_;
  return std::min({position.x, position.y, position.z}) >= 0 && std::max({position.x, position.y, position.z}) < end;
}

bool PointCoder::code_base(BitCoder& coder, Vec3i& position) {
  misses_.emplace_back();
  base_count_ = misses_.size();
  const std::int64_t half = std::int64_t{16} << (grid_bits_ - 1);
  NumberCoder::Guess guess;
  guess.value = half;
  guess.scale = half / 4;
  for (int c = 0; c < 3; ++c) position[c] = base_.code(coder, position[c], guess);
  return is_on_grid(position);
}

bool PointCoder::code_loose(BitCoder& coder, const Vec3i& guess, Vec3i& position) {
  misses_.push_back({kUsualNormalMiss, kUsualTangentMiss});
  NumberCoder::Guess likely;
  likely.scale = std::int64_t{16} << (grid_bits_ - 5);
  for (int c = 0; c < 3; ++c) {
    likely.value = guess[c] * 16;
    position[c] = loose_.code(coder, position[c], likely);
  }
  return is_on_grid(position);
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
  const Vec3i& n = ring_.normal;
  for (std::size_t i = 0; i < Ring::kPulls; ++i) {
    const Vec3i pull = over_radius(ring_.pulls[i], ring_.radius);
    prediction_.normal[i] = along(pull, n);
    const Vec3i rest = pull - times(n, prediction_.normal[i]);
    for (int c = 0; c < 3; ++c) prediction_.tangent[static_cast<std::size_t>(c)][i] = rest[c];
  }
  const std::size_t size = size_class(closed);
  Vec3i shift = times(n, normal_pulls_[size].predict(prediction_.normal));
  for (int c = 0; c < 3; ++c)
    shift[c] += tangent_pulls_[size].predict(prediction_.tangent[static_cast<std::size_t>(c)]);
  const std::int64_t r = ring_.radius;
  prediction_.point = ring_.mean + shift * r / kOne;
}

void PointCoder::predict_size() {
  const auto across = [&](std::size_t pull) {
    std::int64_t sum = 0;
    for (const Pulls::Features& coordinate : prediction_.tangent) sum += std::abs(coordinate[pull]);
    return sum;
  };
  const int log_one = 64;
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring_.radius));
  prediction_.normal_traits = {log_one,
                               around_.normal,
                               log_of(prediction_.normal[0]) - log_one,
                               around_.tangent,
                               log_one - log_radius,  // a step of the grid
                               log_of(across(0)) - log_one,
                               ring_.log_least - log_radius,
                               ring_.log_edge - log_radius,
                               ring_.log_beyond - log_radius};
  prediction_.tangent_traits = prediction_.normal_traits;
  prediction_.tangent_traits[2] = log_of(across(2) + std::abs(prediction_.normal[2])) - log_one;
  const auto size = [&](const Traits& fit, const Traits::Features& traits) {
    return static_cast<int>(std::clamp<std::int64_t>(log_radius + fit.predict(traits), 16, 16 * 20));
  };
  prediction_.size = {size(normal_size_, prediction_.normal_traits), size(tangent_size_, prediction_.tangent_traits)};
}

void PointCoder::code_coordinates(BitCoder& coder, Vec3i& position) {
  const Miss& size = prediction_.size;
  const int log_ratio = std::clamp(2 * (size.normal - size.tangent), -16 * 12, 32);
  const Coordinates c = take_apart(ring_, exp2_16(log_ratio + 16 * kRatioBits));
  const std::int64_t sigma = exp2_16(size.tangent);
  NumberCoder::Guess guess;
  guess.hints[2] =
      NumberCoder::hint(ring_.size() - 3, 0, 1) % 4 * 4 + NumberCoder::hint(size.tangent - size.normal, -16, 32) / 4;
  if (ring_.size() > 6) guess.hints[2] = 12 + NumberCoder::hint(size.tangent - size.normal, -16, 32) / 4;
  const auto code = [&](std::uint32_t which, std::int64_t mean) {
    const int axis = c.order[which];
    guess.value = prediction_.point[axis] + mean;
    const std::uint32_t root = square_root(static_cast<std::uint64_t>(c.variance[which]) << kRatioBits);
    guess.scale = sigma * root >> kRatioBits;
    guess.kind = which;
    guess.hints[0] = NumberCoder::hint(static_cast<int>(std::abs(ring_.normal[axis])), 0, 1025);
    guess.hints[1] =
        has_misses_ ? std::min(14U, NumberCoder::hint(which == 2 ? around_.normal : around_.tangent, -128, 8)) : 15;
    position[axis] = numbers_.code(coder, position[axis], guess);
    return std::clamp((position[axis] * 16) - prediction_.point[axis], -kMostResidual, kMostResidual);
  };
  const std::int64_t first = code(0, 0);
  const std::int64_t second_mean = std::clamp(product(first, c.second_of_first), -kMostResidual, kMostResidual);
  const std::int64_t second = code(1, second_mean);
  code(2, product(first, c.third_of_first) + product(second - second_mean, c.third_of_second));
}

void PointCoder::learn(const Vec3i& position, bool closed) {
  const Vec3i& n = ring_.normal;
  const Vec3i shift = over_radius(position * 16 - ring_.mean, ring_.radius);
  const std::int64_t lift = along(shift, n);
  const Vec3i slide = shift - times(n, lift);
  const std::size_t size = size_class(closed);
  normal_pulls_[size].add(prediction_.normal, lift);
  normal_pulls_[size].end_sample();
  for (int c = 0; c < 3; ++c) tangent_pulls_[size].add(prediction_.tangent[static_cast<std::size_t>(c)], slide[c]);
  tangent_pulls_[size].end_sample();

  const Vec3i residual = position * 16 - prediction_.point;
  const std::int64_t off = along(residual, n);
  const std::int64_t slid = square_root(squared(residual - times(n, off)));
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring_.radius));
  const Miss miss = {log_of(std::abs(off) + 3) - log_radius, log_of(slid + 3) - log_radius};
  normal_size_.add(prediction_.normal_traits, miss.normal);
  normal_size_.end_sample();
  tangent_size_.add(prediction_.tangent_traits, miss.tangent);
  tangent_size_.end_sample();
  misses_.push_back(miss);
}

bool PointCoder::code(BitCoder& coder, const PatchMesh& mesh, std::span<const Index> star, bool closed,
                      std::span<const Vec3i> positions, Vec3i& position) {
  ring_.look(mesh, star, closed, positions, normals_);
  find_misses();
  predict(closed);
  predict_size();
  code_coordinates(coder, position);
  if (!is_on_grid(position)) return false;
  learn(position, closed);
  return true;
}

}  // namespace lodestone::detail

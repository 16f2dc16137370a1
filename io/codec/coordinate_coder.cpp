#include "codec/coordinate_coder.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

namespace lodestone::detail {
namespace {

constexpr std::int64_t kLeastVariance = 1 << 10;
constexpr std::int64_t kMostRatio = std::int64_t{1} << 32;
constexpr std::int64_t kMostResidual = std::int64_t{1} << 26;
constexpr std::int64_t kRoundness = 20,
                       kWhole =
                           256;  // the former over the latter: how much of the spread does not follow the ring's shape

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
    return product(normal, normal_variance) + ((across * kRoundness + ring.spread[i][j] * (kWhole - kRoundness)) >> 8);
  };
  Coordinates c;
  const auto put_in_order = [&](std::size_t i) {
    if (std::abs(n[c.order[i]]) > std::abs(n[c.order[i + 1]])) std::swap(c.order[i], c.order[i + 1]);
  };
  for (const std::size_t i : {0, 1, 0}) put_in_order(i);
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

Miss miss_of(const Vec3i& residual, const Ring& ring) {
  const std::int64_t off = along(residual, ring.normal);
  const std::int64_t slid = square_root(squared(residual - times(ring.normal, off)));
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring.radius));
  return {log_of(std::abs(off) + 3) - log_radius, log_of(slid + 3) - log_radius};
}

void CoordinateCoder::code(BitCoder& coder, const Ring& ring, const Expected& expected, int shift, Vec3i& position) {
  const Miss& size = expected.size;
  const int log_ratio = std::clamp(2 * (size.normal - size.tangent), -16 * 12, 32);
  const Coordinates c = take_apart(ring, exp2_16(log_ratio + 16 * kRatioBits));
  const std::int64_t sigma = exp2_16(size.tangent);
  NumberCoder::Guess guess;
  guess.hints[2] =
      static_cast<std::uint32_t>(expected.hint) * 4 + NumberCoder::hint(size.tangent - size.normal, -16, 32) / 4;
  const auto code = [&](std::uint32_t which, std::int64_t mean) {
    const int axis = c.order[which];
    guess.value = (expected.point[axis] + mean) >> shift;
    const std::uint32_t root = square_root(static_cast<std::uint64_t>(c.variance[which]) << kRatioBits);
    guess.scale = (sigma * root >> kRatioBits) >> shift;
    guess.kind = which;
    guess.hints[0] = NumberCoder::hint(static_cast<int>(std::abs(ring.normal[axis])), 0, 1025);
    guess.hints[1] = 15;
    if (expected.around)
      guess.hints[1] =
          std::min(14U, NumberCoder::hint(which == 2 ? expected.around->normal : expected.around->tangent, -128, 8));
    position[axis] = numbers_.code(coder, position[axis] >> shift, guess) * (std::int64_t{1} << shift);
    return std::clamp((position[axis] * 16) - expected.point[axis], -kMostResidual, kMostResidual);
  };
  const std::int64_t first = code(0, 0);
  const std::int64_t second_mean = std::clamp(product(first, c.second_of_first), -kMostResidual, kMostResidual);
  const std::int64_t second = code(1, second_mean);
  code(2, product(first, c.third_of_first) + product(second - second_mean, c.third_of_second));
}

}  // namespace lodestone::detail

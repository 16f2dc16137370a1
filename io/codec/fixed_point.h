#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

// Arithmetic that steers decoding: integers only, so that every machine finds the same.

namespace lodestone::detail {

// In functions they would be copied to the stack.
inline constexpr std::array<std::uint8_t, 64> kLogs = {0,  1,  1,  1,  2,  2,  2,  3,  3,  3,  4,  4,  4,  4,  5,  5,
                                                       5,  6,  6,  6,  6,  7,  7,  7,  7,  8,  8,  8,  9,  9,  9,  9,
                                                       9,  10, 10, 10, 10, 11, 11, 11, 11, 12, 12, 12, 12, 12, 13, 13,
                                                       13, 13, 13, 14, 14, 14, 14, 14, 15, 15, 15, 15, 15, 16, 16, 16};
inline constexpr std::array<std::uint16_t, 16> kPowers = {4096, 4277, 4467, 4664, 4871, 5087, 5312, 5547,
                                                          5793, 6049, 6317, 6597, 6889, 7194, 7512, 7845};

/// Returns 16 · log2(x), rounded to about one unit; 0 for x = 0.
constexpr int log2_16(std::uint64_t x) {
  const int zeros = std::countl_zero(x | 1);
  return 16 * (63 - zeros) + kLogs[x << zeros >> 57U & 63U];
}

/// Returns 16 · log2(|x| + 1), likewise.
inline int log_of(std::int64_t x) { return log2_16(static_cast<std::uint64_t>(std::abs(x)) + 1); }

/// Returns 2^(x / 16), for x in 0 … 16 · 40, rounded down; 1 for less.
constexpr std::int64_t exp2_16(int x) {
  x = std::clamp(x, 0, 640);
  return static_cast<std::int64_t>(std::uint64_t{kPowers[x % 16]} << (x / 16) >> 12U);
}

/// Returns the square root, rounded down. Floats only find where to look; up to 2^52 the next number is too far from
/// what they find to be taken for it.
inline std::uint32_t square_root(std::uint64_t x) {
  if (x < std::uint64_t{1} << 52U)
    return static_cast<std::uint32_t>(std::sqrt(static_cast<double>(static_cast<std::int64_t>(x))));
  auto root = std::min<std::uint64_t>(static_cast<std::uint64_t>(std::sqrt(static_cast<double>(x))), 0xFFFFFFFFU);
  while (root * root > x) --root;
  while (root < 0xFFFFFFFFU && (root + 1) * (root + 1) <= x) ++root;
  return static_cast<std::uint32_t>(root);
}

/// Divides, rounding to nearest, halves up. Pre: b > 0.
constexpr std::int64_t divide(std::int64_t a, std::int64_t b) {
  const std::int64_t doubled = 2 * a + b;
  const std::int64_t quotient = doubled / (2 * b);
  return quotient - (doubled % (2 * b) < 0 ? 1 : 0);
}

/// Numbers a value's step from `low` on, 0 … count − 1; what lies beyond counts as the last.
constexpr std::uint32_t bucket(int value, int low, int step, std::uint32_t count) {
  return std::min(static_cast<std::uint32_t>(std::max(value - low, 0)) / static_cast<std::uint32_t>(step), count - 1);
}

struct Vec3i {
  std::int64_t x = 0, y = 0, z = 0;

  std::int64_t operator[](int c) const { return c == 0 ? x : c == 1 ? y : z; }
  std::int64_t& operator[](int c) { return c == 0 ? x : c == 1 ? y : z; }
  friend Vec3i operator+(const Vec3i& a, const Vec3i& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3i operator-(const Vec3i& a, const Vec3i& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3i operator*(const Vec3i& a, std::int64_t s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3i operator/(const Vec3i& a, std::int64_t s) { return {a.x / s, a.y / s, a.z / s}; }
  friend bool operator==(const Vec3i&, const Vec3i&) = default;
};

constexpr std::int64_t dot(const Vec3i& a, const Vec3i& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3i cross(const Vec3i& a, const Vec3i& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3i divide(const Vec3i& a, std::int64_t b) { return {divide(a.x, b), divide(a.y, b), divide(a.z, b)}; }
/// Halves a vector until its coordinates have no more than so many bits; says how often.
inline int shorten(Vec3i& v, int bits) {
  const auto largest = static_cast<std::uint64_t>(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
  const int shift = std::max(0, static_cast<int>(std::bit_width(largest)) - bits);
  v = {v.x >> shift, v.y >> shift, v.z >> shift};
  return shift;
}
/// Returns the axis in which a vector is longest, of those alike the last.
inline int longest_axis(const Vec3i& v) {
  const std::int64_t x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
  return x > y && x > z ? 0 : y > z ? 1 : 2;
}
inline std::uint64_t squared(const Vec3i& a) { return static_cast<std::uint64_t>(dot(a, a)); }

}  // namespace lodestone::detail

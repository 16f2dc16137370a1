#pragma once

#include <cstdint>

namespace lodestone::test {

/// A small generator (SplitMix64): the same numbers from every compiler and library, which std:: does not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// Returns a number in [0, bound), near enough to uniform for tests; pre: bound > 0.
  std::uint64_t below(std::uint64_t bound) { return next() % bound; }

  /// Returns a number in [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  /// Returns a number in [−1, 1).
  double signed_unit() { return 2 * unit() - 1; }

 private:
  std::uint64_t state_;
};

}  // namespace lodestone::test

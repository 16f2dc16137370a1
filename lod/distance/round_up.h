#pragma once

#include <cmath>
#include <limits>

namespace lodestone::detail {

/// Rounds to a float that is no less, so that a bound stays one.
inline float round_up(double value) {
  const auto f = static_cast<float>(value);
  return static_cast<double>(f) < value ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

}  // namespace lodestone::detail

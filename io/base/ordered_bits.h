#pragma once

#include <cstdint>
#include <cstring>

namespace lodestone::detail {

inline constexpr std::uint32_t kSignBit = 0x80000000U;

/// Numbers floats as they lie along the axis; what is no number lies beyond the infinities, and the zeros apart.
inline std::uint32_t ordered_bits(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);  // Emscripten's library has no std::bit_cast
  return (bits & kSignBit) != 0 ? ~bits : bits | kSignBit;
}

inline float from_ordered_bits(std::uint32_t ordered) {
  const std::uint32_t bits = (ordered & kSignBit) != 0 ? ordered & ~kSignBit : ~ordered;
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace lodestone::detail

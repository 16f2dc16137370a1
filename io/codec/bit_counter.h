#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "codec/bit_coder.h"

namespace lodestone::detail {

/// How fast a counter learns, by how often it was seen.
inline constexpr std::array<std::uint32_t, 61> kCounterRates = [] {
  std::array<std::uint32_t, 61> rates{};
  for (std::uint32_t seen = 0; seen < rates.size(); ++seen) rates[seen] = 2 * 65536 / (2 * seen + 3);
  return rates;
}();

/// The probability of a bit, learnt from those that went by: their mean up to so many, and then one that forgets.
class BitCounter {
 public:
  /// Of a 1, / 65536; in 1 … 65535.
  std::uint32_t one() const { return one_; }

  /// Counts a bit; `flip`: 65535 for 1, 0 for 0. It forgets as an average over `slowest` bits does, 60 at most.
  void add(std::uint32_t flip, std::uint16_t slowest) {
    const std::uint32_t other = one_ ^ flip;  // counts zeros as ones
    one_ = static_cast<std::uint16_t>((other - (other * kCounterRates[seen_] >> 16U)) ^ flip);
    seen_ = static_cast<std::uint16_t>(seen_ + (seen_ < slowest ? 1 : 0));
  }

  /// Codes a bit by this alone. `coder`: a BitCoder or BitRun.
  template <class Coder>
  int code(Coder& coder, int bit) {
    bit = coder.code(bit, one_);
    add(bit != 0 ? 65535 : 0, kCounterRates.size() - 1);
    return bit;
  }

 private:
  std::uint16_t one_ = 32768;
  std::uint16_t seen_ = 0;
};

}  // namespace lodestone::detail

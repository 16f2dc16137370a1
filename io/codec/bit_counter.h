#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "codec/bit_coder.h"

namespace lodestone::detail {

/// How fast a counter learns, by how often it was seen, up to a limit.
struct CounterRate {
  std::uint16_t rate = 0;  ///< / 65536
  std::uint16_t next = 0;  ///< the number it is seen by then
};
template <std::size_t kSlowest>
inline constexpr std::array<CounterRate, kSlowest + 1> kCounterRates = [] {
  std::array<CounterRate, kSlowest + 1> rates{};
  for (std::size_t seen = 0; seen <= kSlowest; ++seen)
    rates[seen] = {static_cast<std::uint16_t>(2 * 65536 / (2 * seen + 3)),
                   static_cast<std::uint16_t>(seen < kSlowest ? seen + 1 : kSlowest)};
  return rates;
}();

/// The probability of a bit, learnt from those that went by: their mean up to so many, and then one that forgets.
class BitCounter {
 public:
  /// Of a 1, / 65536; in 1 … 65535.
  std::uint32_t one() const { return one_; }

  /// Counts a bit; `flip`: 65535 for 1, 0 for 0. It forgets as an average over so many bits does as `rates` go up to.
  template <std::size_t N>
  void add(std::uint32_t flip, const std::array<CounterRate, N>& rates) {
    const CounterRate& rate = rates[seen_];
    const std::uint32_t other = one_ ^ flip;  // counts zeros as ones
    one_ = static_cast<std::uint16_t>((other - (other * rate.rate >> 16U)) ^ flip);
    seen_ = rate.next;
  }

  /// Codes a bit by this alone. `coder`: a BitCoder or BitRun.
  template <class Coder>
  int code(Coder& coder, int bit) {
    const CounterRate& rate = kCounterRates<60>[seen_];
    seen_ = rate.next;
    const std::uint32_t one = one_;
    bit = coder.code(bit, one);
    one_ = static_cast<std::uint16_t>(bit != 0 ? one + ((65535 - one) * rate.rate >> 16U)
                                               : one - (one * rate.rate >> 16U));
    return bit;
  }

 private:
  std::uint16_t one_ = 32768;
  std::uint16_t seen_ = 0;
};

}  // namespace lodestone::detail

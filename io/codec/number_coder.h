#pragma once

#include <cstdint>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/fixed_point.h"

namespace lodestone::detail {

/// Codes whole numbers that lie around a predicted value, the closer the likelier.
class NumberCoder {
 public:
  static constexpr std::uint32_t kHints = 16;
  /// A value as a hint: its step from `low` on.
  static constexpr std::uint32_t hint(int value, int low, int step) { return bucket(value, low, step, kHints); }

  /// What is known of a number before it is coded; lengths in sixteenths.
  struct Guess {
    std::int64_t value = 0;       ///< sixteenths
    std::int64_t scale = 16;      ///< sixteenths: about the expected distance from it
    std::uint32_t kind = 0;       ///< < 4
    std::uint32_t hints[3] = {};  ///< < kHints: whatever else may tell of its distribution
  };

  NumberCoder();
  /// Codes a number; a reader passes anything.
  std::int64_t code(BitCoder& coder, std::int64_t number, const Guess& guess);

 private:
  BitMixer steps_;
  BitMixer rest_;
};

}  // namespace lodestone::detail

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "codec/bit_coder.h"
#include "codec/bit_counter.h"
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

  /// Codes a number; a reader passes anything. By a fast coder, of hints nothing counts.
  std::int64_t code(BitCoder& coder, std::int64_t number, const Guess& guess) {
    return coder.is_fast() ? code_counted(coder, number, guess) : code_mixed(coder, number, guess);
  }

 private:
  struct Mixers {
    BitMixer<5> steps;
    BitMixer<2> rest;
    Mixers();
  };
  std::int64_t code_mixed(BitCoder& coder, std::int64_t number, const Guess& guess);
  std::int64_t code_counted(BitCoder& coder, std::int64_t number, const Guess& guess);
  template <bool kReads>
  std::int64_t code_counted(BitCoder& coder, std::int64_t number, const Guess& guess);

  // Either, from the first number on.
  std::optional<Mixers> mixers_;
  std::vector<BitCounter> counters_;
};

}  // namespace lodestone::detail

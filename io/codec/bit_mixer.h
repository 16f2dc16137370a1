#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codec/bit_coder.h"
#include "codec/bit_counter.h"
#include "codec/lanes.h"

namespace lodestone::detail {

/// Models one kind of bit by several contexts at once: each has a probability of its own, and their logarithms of odds
/// are added up with weights that are learnt as bits go by.
///
/// Source: logistic mixing as in Mahoney, Adaptive weighing of context models for lossless data compression (2005).
class BitMixer {
 public:
  static constexpr int kMostInputs = Lanes::kCount;

  /// One input for each entry of `context_counts`, whose contexts are numbered below it; a set of weights for each of
  /// `selector_count`.
  BitMixer(std::span<const std::uint32_t> context_counts, std::uint32_t selector_count);

  /// Codes a bit. `contexts`: one for each input. Pre: all are below their counts.
  int code(BitCoder& coder, int bit, std::span<const std::uint32_t> contexts, std::uint32_t selector);

 private:
  template <std::size_t... I>
  int code_mixed(BitCoder& coder, int bit, const std::uint32_t* contexts, std::uint32_t selector,
                 std::index_sequence<I...>);

  int input_count_;
  std::array<std::uint32_t, kMostInputs> first_{};  // of each input's counters
  std::vector<BitCounter> counters_;
  std::vector<Lanes> weights_;       // by selector: 13 fractional bits
  std::vector<std::uint16_t> used_;  // by selector: how often, up to a limit
};

}  // namespace lodestone::detail

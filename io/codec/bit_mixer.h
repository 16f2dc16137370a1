#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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
/// The number of inputs is known to the compiler: they are what most of the time goes into.
template <int kInputs>
class BitMixer {
 public:
  using Contexts = std::array<std::uint32_t, kInputs>;

  /// `context_counts`: an input's contexts are numbered below its; a set of weights for each of `selector_count`.
  BitMixer(const Contexts& context_counts, std::uint32_t selector_count);

  /// Codes a bit. `contexts`: one for each input. Pre: all are below their counts.
  int code(BitCoder& coder, int bit, const Contexts& contexts, std::uint32_t selector);

 private:
  static_assert(kInputs <= Lanes::kCount);
  struct Weights {
    Lanes lanes;         // 13 fractional bits
    std::uint16_t used;  // how often, up to a limit
  };
  template <std::size_t... I>
  int code(BitCoder& coder, int bit, const Contexts& contexts, std::uint32_t selector, std::index_sequence<I...>);

  std::array<std::uint32_t, kInputs> first_{};  // of each input's counters
  std::vector<BitCounter> counters_;
  std::vector<Weights> weights_;  // by selector
};

extern template class BitMixer<1>;
extern template class BitMixer<2>;
extern template class BitMixer<5>;
extern template class BitMixer<7>;
extern template class BitMixer<8>;

}  // namespace lodestone::detail

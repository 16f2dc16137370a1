#include "codec/bit_mixer.h"

#include <algorithm>
#include <cassert>

namespace lodestone::detail {
namespace {

// Logarithms of odds have 8 fractional bits.
constexpr int kOddsLimit = 2815;
constexpr int kAnchorStep = 128;

constexpr std::array<std::int32_t, 45> kAnchors = {
    1,     2,     3,     5,     8,     13,    22,    36,    60,    98,    162,   267,   439,   720,   1179,
    1921,  3108,  4971,  7812,  11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565, 62428, 63615,
    64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514, 65523, 65528, 65531, 65533, 65534, 65535};

constexpr std::int32_t probability(int odds) {
  const int x = std::clamp(odds, -kOddsLimit, kOddsLimit) + kAnchorStep * 22;
  const int i = x / kAnchorStep, rest = x % kAnchorStep;
  return kAnchors[i] + (kAnchors[i + 1] - kAnchors[i]) * rest / kAnchorStep;
}

constexpr std::array<std::int16_t, 4096> make_odds() {
  std::array<std::int16_t, 4096> table{};
  int odds = -kOddsLimit;
  for (int i = 0; i < 4096; ++i) {
    while (odds < kOddsLimit && probability(odds) < 16 * i + 8) ++odds;
    table[i] = static_cast<std::int16_t>(odds);
  }
  return table;
}
constexpr std::array<std::int16_t, 4096> kOdds = make_odds();

constexpr int kWeightBits = 13;         // fractional: weights lie within 4
constexpr std::uint16_t kSlowest = 30;  // a counter forgets as an average over this many bits does

constexpr int kWeightsSettle = 60;  // bits after which weights are learnt more slowly

}  // namespace

BitMixer::BitMixer(std::span<const std::uint32_t> context_counts, std::uint32_t selector_count)
    : input_count_(static_cast<int>(context_counts.size())) {
  assert(input_count_ == 1 || input_count_ == 2 || input_count_ == 5 || input_count_ == 7 || input_count_ == 8);
  std::uint32_t count = 0;
  for (int i = 0; i < input_count_; ++i) {
    first_[i] = count;
    count += context_counts[i];
  }
  counters_.resize(count);
  const auto weight = static_cast<std::int16_t>((12 << kWeightBits) / 10 / input_count_);
  // Those of inputs that are not there are never asked for.
  weights_.assign(selector_count, Lanes(weight, weight, weight, weight, weight, weight, weight, weight));
  used_.assign(selector_count, 0);
}

/// The number of inputs is known to the compiler: it is what most of the time goes into.
template <std::size_t... I>
int BitMixer::code_mixed(BitCoder& coder, int bit, const std::uint32_t* contexts, std::uint32_t selector,
                         std::index_sequence<I...>) {
  BitCounter* const counters[] = {&counters_[first_[I] + contexts[I]]...};
  const Lanes odds(kOdds[counters[I]->one() >> 4U]...);
  Lanes& weights = weights_[selector];
  const int mixed = std::clamp(dot(odds, weights) >> kWeightBits, -kOddsLimit, kOddsLimit);
  const std::int32_t one = std::clamp(probability(mixed), 16, 65520);
  bit = coder.code(bit, static_cast<std::uint32_t>(one));

  const bool has_settled = used_[selector] >= kWeightsSettle;
  if (!has_settled) ++used_[selector];
  weights.add_product(odds, static_cast<std::int16_t>(((bit << 16U) - bit - one) >> (has_settled ? 2 : 1)));
  const std::uint32_t flip = bit != 0 ? 65535 : 0;
  (counters[I]->add(flip, kSlowest), ...);
  return bit;
}

int BitMixer::code(BitCoder& coder, int bit, std::span<const std::uint32_t> contexts, std::uint32_t selector) {
  switch (input_count_) {
    case 1:
      return code_mixed(coder, bit, contexts.data(), selector, std::make_index_sequence<1>());
    case 2:
      return code_mixed(coder, bit, contexts.data(), selector, std::make_index_sequence<2>());
    case 5:
      return code_mixed(coder, bit, contexts.data(), selector, std::make_index_sequence<5>());
    case 7:
      return code_mixed(coder, bit, contexts.data(), selector, std::make_index_sequence<7>());
    default:
      return code_mixed(coder, bit, contexts.data(), selector, std::make_index_sequence<8>());
  }
}

}  // namespace lodestone::detail

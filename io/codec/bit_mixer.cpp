#include "codec/bit_mixer.h"

#include <algorithm>

namespace lodestone::detail {
namespace {

// Logarithms of odds have 8 fractional bits.
constexpr int kOddsLimit = 2815;
constexpr int kAnchorStep = 128;

constexpr std::array<std::int32_t, 45> kAnchors = {
    1,     2,     3,     5,     8,     13,    22,    36,    60,    98,    162,   267,   439,   720,   1179,
    1921,  3108,  4971,  7812,  11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565, 62428, 63615,
    64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514, 65523, 65528, 65531, 65533, 65534, 65535};

/// Of odds within the limit.
constexpr std::int32_t probability(int odds) {
  const auto x = static_cast<std::uint32_t>(odds + kAnchorStep * 22);
  const std::uint32_t i = x / kAnchorStep, rest = x % kAnchorStep;
  const std::int32_t low = kAnchors[i];
  return low + static_cast<std::int32_t>(static_cast<std::uint32_t>(kAnchors[i + 1] - low) * rest / kAnchorStep);
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

constexpr int kWeightBits = 13;       // fractional: weights lie within 4
constexpr std::size_t kSlowest = 30;  // a counter forgets as an average over this many bits does

constexpr int kWeightsSettle = 60;  // bits after which weights are learnt more slowly

}  // namespace

template <int kInputs>
BitMixer<kInputs>::BitMixer(const Contexts& context_counts, std::uint32_t selector_count) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < kInputs; ++i) {
    first_[i] = count;
    count += context_counts[i];
  }
  counters_.resize(count);
  const auto weight = static_cast<std::int16_t>((12 << kWeightBits) / 10 / kInputs);
  // Those of inputs that are not there are never asked for.
  weights_.assign(selector_count, {Lanes(weight, weight, weight, weight, weight, weight, weight, weight), 0});
}

template <int kInputs>
int BitMixer<kInputs>::code(BitCoder& coder, int bit, const Contexts& contexts, std::uint32_t selector) {
  return code(coder, bit, contexts, selector, std::make_index_sequence<kInputs>());
}

template <int kInputs>
template <std::size_t... I>
int BitMixer<kInputs>::code(BitCoder& coder, int bit, const Contexts& contexts, std::uint32_t selector,
                            std::index_sequence<I...>) {
  BitCounter* const counters[] = {&counters_[first_[I] + contexts[I]]...};
  const Lanes odds(kOdds[counters[I]->one() >> 4U]...);
  Weights& weights = weights_[selector];
  const int mixed = std::clamp(dot(odds, weights.lanes) >> kWeightBits, -kOddsLimit, kOddsLimit);
  const std::int32_t one = std::clamp(probability(mixed), 16, 65520);
  bit = coder.code(bit, static_cast<std::uint32_t>(one));

  const bool has_settled = weights.used >= kWeightsSettle;
  if (!has_settled) ++weights.used;
  weights.lanes.add_product(odds, static_cast<std::int16_t>(((bit << 16U) - bit - one) >> (has_settled ? 2 : 1)));
  const std::uint32_t flip = bit != 0 ? 65535 : 0;
  (counters[I]->add(flip, kCounterRates<kSlowest>), ...);
  return bit;
}

template class BitMixer<1>;
template class BitMixer<2>;
template class BitMixer<5>;
template class BitMixer<7>;
template class BitMixer<8>;

}  // namespace lodestone::detail

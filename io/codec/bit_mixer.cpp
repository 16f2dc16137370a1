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

constexpr std::int64_t kMostWeight = 1 << 20U;
constexpr int kSlowest = 150;  // a counter forgets as an average over this many bits does
constexpr std::array<std::int32_t, kSlowest + 1> make_rates() {
  std::array<std::int32_t, kSlowest + 1> rates{};
  for (int seen = 0; seen <= kSlowest; ++seen) rates[seen] = 2 * 65536 / (2 * seen + 3);
  return rates;
}
constexpr std::array<std::int32_t, kSlowest + 1> kRates = make_rates();  // by how often a counter was seen

constexpr int kWeightsSettle = 60;  // bits after which weights are learnt more slowly

}  // namespace

BitMixer::BitMixer(std::span<const std::uint32_t> context_counts, std::uint32_t selector_count)
    : input_count_(static_cast<int>(context_counts.size())) {
  assert(input_count_ == 1 || input_count_ == 2 || input_count_ == 5 || input_count_ == 7 || input_count_ == 9);
  std::uint32_t count = 0;
  for (int i = 0; i < input_count_; ++i) {
    first_[i] = count;
    count += context_counts[i];
  }
  counters_.resize(count);
  weights_.assign(std::size_t(input_count_) * selector_count, 65536 * 12 / 10 / input_count_);
  used_.assign(selector_count, 0);
}

/// The number of inputs is known to the compiler: it is what most of the time goes into.
template <int N>
int BitMixer::code_mixed(BitCoder& coder, int bit, const std::uint32_t* contexts, std::uint32_t selector) {
  std::array<std::int32_t, N> odds;
  std::array<Counter*, N> counters;
  std::int32_t* weights = weights_.data() + std::size_t(selector) * N;
  std::int64_t sum = 0;
  for (int i = 0; i < N; ++i) {
    counters[i] = &counters_[first_[i] + contexts[i]];
    odds[i] = kOdds[counters[i]->one >> 4U];
    sum += std::int64_t{odds[i]} * weights[i];
  }
  const int mixed = static_cast<int>(std::clamp<std::int64_t>(sum >> 16U, -kOddsLimit, kOddsLimit));
  const std::int32_t one = std::clamp(probability(mixed), 16, 65520);
  bit = coder.code(bit, static_cast<std::uint32_t>(one));

  const std::int32_t error = (bit << 16U) - bit - one;
  const int rate = used_[selector] < kWeightsSettle ? 14 : 15;
  if (used_[selector] < kWeightsSettle) ++used_[selector];
  const std::int32_t target = bit != 0 ? 65535 : 0;
  for (int i = 0; i < N; ++i) {
    const std::int64_t shift = (std::int64_t{odds[i]} * error + (1 << (rate - 1))) >> rate;
    weights[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(weights[i] + shift, -kMostWeight, kMostWeight));
    Counter& counter = *counters[i];
    const auto step = static_cast<std::int32_t>((std::int64_t{target - counter.one} * kRates[counter.seen]) >> 16);
    counter.one = static_cast<std::uint16_t>(counter.one + step);
    if (counter.seen < kSlowest) ++counter.seen;
  }
  return bit;
}

int BitMixer::code(BitCoder& coder, int bit, std::span<const std::uint32_t> contexts, std::uint32_t selector) {
  switch (input_count_) {
    case 1:
      return code_mixed<1>(coder, bit, contexts.data(), selector);
    case 2:
      return code_mixed<2>(coder, bit, contexts.data(), selector);
    case 5:
      return code_mixed<5>(coder, bit, contexts.data(), selector);
    case 7:
      return code_mixed<7>(coder, bit, contexts.data(), selector);
    default:
      return code_mixed<9>(coder, bit, contexts.data(), selector);
  }
}

}  // namespace lodestone::detail

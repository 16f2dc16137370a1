#include "codec/number_coder.h"

#include <algorithm>
#include <array>
#include <bit>

#include "codec/fixed_point.h"

namespace lodestone::detail {
namespace {

// A number lies on one side of the prediction, so many steps away; the ends of steps in sixteenths of the scale.
constexpr std::array<int, 14> kSteps = {5, 11, 18, 26, 36, 48, 64, 86, 118, 170, 256, 450, 1000, 4000};
constexpr std::uint32_t kNodes = 20;
constexpr std::uint32_t kScales = 24;
constexpr std::uint32_t kFractions = 8;

constexpr std::array<std::uint32_t, 5> kStepContexts = {
    kNodes * 2 * kScales, kNodes* kFractions * 8, kNodes * 4 * NumberCoder::kHints, kNodes * 4 * NumberCoder::kHints,
    kNodes* NumberCoder::kHints * 4};
constexpr std::array<std::uint32_t, 2> kRestContexts = {kNodes * 4, kNodes* kScales};

// Of a fast coder: the scale's bits, in sixteenths, above those of a step; how many steps are even; the longest one.
constexpr int kUnitBelow = 7;
constexpr int kEvenSteps = 8;
constexpr int kLastNode = kNodes - 1;
constexpr int kMostStepBits = 32;

}  // namespace

NumberCoder::Mixers::Mixers() : steps(kStepContexts, kNodes * 4), rest(kRestContexts, 4) {}

std::int64_t NumberCoder::code_mixed(BitCoder& coder, std::int64_t number, const Guess& guess) {
  if (!mixers_) mixers_.emplace();
  const std::int64_t scale = std::max<std::int64_t>(guess.scale, 1);
  const std::int64_t first = (guess.value + 15) >> 4;  // the least number not below the prediction
  const auto fraction = static_cast<std::uint32_t>(((first << 4) - guess.value) >> 1);  // 0 … 7
  const std::uint32_t log_scale = bucket(log2_16(static_cast<std::uint64_t>(scale)), 16, 8, kScales);
  const auto small =
      static_cast<std::uint32_t>(std::clamp((log2_16(static_cast<std::uint64_t>(scale)) - 32) / 8, 0, 7));
  std::uint32_t side = 0;
  const auto code_step = [&](std::uint32_t node, int bit) {
    const std::uint32_t f = node < 4 ? (side != 0 ? fraction : fraction ^ 7U) : 0;
    const std::array<std::uint32_t, 5> contexts = {
        (node * 2 + (small < 7 ? side : 0)) * kScales + log_scale, (node * kFractions + f) * 8 + small,
        (node * 4 + guess.kind) * kHints + guess.hints[0], (node * 4 + guess.kind) * kHints + guess.hints[1],
        (node * kHints + guess.hints[2]) * 4 + std::min(small / 2, 3U)};
    return mixers_->steps.code(coder, bit, contexts, node * 4 + guess.kind);
  };
  side = static_cast<std::uint32_t>(code_step(0, number >= first ? 1 : 0));
  const std::int64_t distance = side != 0 ? number - first : first - 1 - number;
  // Steps outwards, then halving within the step.
  std::int64_t begin = 0, end = 0;
  std::uint32_t step = 0;
  for (;; ++step) {
    if (step + 2 >= kNodes) {
      end = begin + (std::int64_t{1} << 34);
      break;
    }
    end = step < kSteps.size() ? std::max(begin + 1, (scale * kSteps[step] + 128) >> 8) : 2 * begin + 1;
    if (code_step(1 + step, distance >= end ? 1 : 0) == 0) break;
    begin = end;
  }
  int level = 0;
  while (end - begin > 1) {
    const std::int64_t middle = begin + (end - begin) / 2;
    const std::array<std::uint32_t, 2> contexts = {step * 4 + static_cast<std::uint32_t>(std::min(level, 3)),
                                                   step * kScales + log_scale};
    int upper = distance >= middle ? 1 : 0;
    if (level < 2)
      upper = mixers_->rest.code(coder, upper, contexts, static_cast<std::uint32_t>(level));
    else
      upper = coder.code(upper, 32768);
    (upper != 0 ? begin : end) = middle;
    ++level;
  }
  return side != 0 ? first + begin : first - 1 - begin;
}

/// Steps outwards are half the scale or less, a power of two, from the ninth on twice as long each; where in its step
/// the number lies are raw bits.
template <bool kReads>
std::int64_t NumberCoder::code_counted(BitCoder& coder, std::int64_t number, const Guess& guess) {
  if (counters_.empty()) counters_.resize(std::size_t{4} * kScales * kNodes);
  const auto scale = static_cast<std::uint64_t>(std::max<std::int64_t>(guess.scale, 1));
  const int unit = std::clamp(static_cast<int>(std::bit_width(scale)) - kUnitBelow, 0, kMostStepBits - 1);
  BitCounter* const nodes = &counters_[(guess.kind * kScales + bucket(log2_16(scale), 16, 8, kScales)) * kNodes];
  const std::int64_t first = (guess.value + 15) >> 4;
  const auto begin_of = [&](int step) {
    if (step <= kEvenSteps) return std::int64_t{step} << unit;
    return (kEvenSteps - 2 + (std::int64_t{2} << (step - kEvenSteps))) << unit;
  };
  const int last = kEvenSteps + kMostStepBits - 1 - unit;
  int side = number >= first ? 1 : 0, wanted = 0;
  const std::int64_t distance = side != 0 ? number - first : first - 1 - number;
  if (!kReads)
    while (wanted < last && distance >= begin_of(wanted + 1)) ++wanted;
  BitRun<kReads> run(coder);
  side = nodes[0].code(run, side);
  int step = 0;
  while (step < last && nodes[std::min(step + 1, kLastNode)].code(run, step < wanted ? 1 : 0) != 0) ++step;
  std::int64_t begin = begin_of(step);
  const int bits = unit + std::max(step - kEvenSteps + 1, 0);
  begin += run.code_raw(static_cast<std::uint32_t>(distance - begin), bits);
  return side != 0 ? first + begin : first - 1 - begin;
}

std::int64_t NumberCoder::code_counted(BitCoder& coder, std::int64_t number, const Guess& guess) {
  return coder.is_reading() ? code_counted<true>(coder, number, guess) : code_counted<false>(coder, number, guess);
}

}  // namespace lodestone::detail

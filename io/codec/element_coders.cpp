#include "codec/element_coders.h"

#include <algorithm>
#include <cstdlib>

namespace lodestone::detail {

PlainElementCoder::PlainElementCoder(const AttributeSpec& spec)
    : ElementCoder(spec), misses_(spec.component_count, 256) {}

/// Codes an element without a ring.
bool PlainElementCoder::code_alone(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  const std::int64_t lowest = spec().lowest(), highest = spec().highest();
  NumberCoder::Guess guess;
  guess.scale = std::max<std::int64_t>(16, (highest - lowest) / 2);
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    guess.kind = static_cast<std::uint32_t>(std::min<std::size_t>(c, 3));
    guess.value = 16 * (place.beside != kNoIndex ? number(place.beside, c) : lowest + (highest - lowest) / 2);
    const std::int64_t coded = alone_.code(coder, numbers[c], guess);
    if (coded < lowest || coded > highest) return false;
    numbers[c] = static_cast<std::int32_t>(coded);
  }
  return true;
}

bool PlainElementCoder::code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  if (place.ring.empty()) return code_alone(coder, place, numbers);
  const std::int64_t lowest = spec().lowest(), highest = spec().highest();
  const auto count = static_cast<std::int64_t>(place.ring.size());
  std::uint32_t off = 0;  // whether the component before was foretold
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    std::int64_t sum = 0, spread = 0;
    for (const Index other : place.ring) sum += number(other, c);
    const std::int64_t mean = divide(16 * sum, count);
    for (const Index other : place.ring) spread += std::abs(16 * number(other, c) - mean);
    spread /= count;
    NumberCoder::Guess guess;
    guess.value = mean;
    guess.scale = (spread + misses_[c]) / 2 + 1;
    guess.kind = static_cast<std::uint32_t>(std::min<std::size_t>(c, 3));
    guess.hints[0] = spread == 0 ? 0 : 1 + NumberCoder::hint(log_of(spread), 0, 16) * 14 / 15;
    guess.hints[1] = NumberCoder::hint(log_of(misses_[c]), 0, 16);
    guess.hints[2] = (spread == 0 ? 8 : 0) + off;
    const std::int64_t coded = numbers_.code(coder, numbers[c], guess);
    if (coded < lowest || coded > highest) return false;
    numbers[c] = static_cast<std::int32_t>(coded);
    const std::int64_t miss = std::abs(16 * coded - mean);
    misses_[c] += (std::min(miss, 16 * misses_[c] + 256) - misses_[c]) / 16;
    off = c == 0 || off > 0 ? (miss > 8 ? 1U : 0U) + 1 : off;
  }
  return true;
}

}  // namespace lodestone::detail

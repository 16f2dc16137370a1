#include "codec/weight_coder.h"

#include <algorithm>
#include <cstdlib>

namespace lodestone::detail {

WeightCoder::WeightCoder(const AttributeSpec& spec, const SkinSets& skin, std::size_t set)
    : ElementCoder(spec), skin_(skin), set_(set) {}

/// The mean weight of a joint over the ring, in sixteenths.
std::int64_t WeightCoder::weight_around(const ElementPlace& place, std::int32_t joint) const {
  std::int64_t sum = 0;
  for (const Index other : place.ring)
    for (const SkinSets::Set& set : skin_.sets) {
      if (set.joints == nullptr) continue;
      const std::span<const std::int32_t> joints = set.joints->numbers(other), weights = set.weights->numbers(other);
      for (std::size_t k = 0; k < joints.size(); ++k) sum += joints[k] == joint ? weights[k] : 0;
    }
  return divide(16 * sum, static_cast<std::int64_t>(place.ring.size()));
}

bool WeightCoder::code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  const SkinSets::Set& own = skin_.sets[set_];
  const bool is_last = set_ + 1 == skin_.sets.size();
  std::int64_t rest = spec().highest();
  for (std::size_t i = 0; i < set_; ++i)
    for (const std::int32_t number : skin_.sets[i].weights->numbers(place.wedge)) rest -= number;
  if (rest < 0) return false;
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    if ((is_last && c + 1 == numbers.size()) || rest == 0) {
      numbers[c] = static_cast<std::int32_t>(is_last && c + 1 == numbers.size() ? rest : 0);
      rest -= numbers[c];
      continue;
    }
    NumberCoder::Guess guess;
    const bool has_ring = !place.ring.empty();
    if (has_ring && own.joints != nullptr) guess.value = weight_around(place, own.joints->numbers(place.wedge)[c]);
    if (!has_ring && place.beside != kNoIndex) guess.value = 16 * number(place.beside, c);
    guess.value = std::min(guess.value, 16 * rest);
    const std::int64_t slack = std::min(guess.value, 16 * rest - guess.value);
    guess.scale = std::max<std::int64_t>(8, std::min(slack, 2 * miss_) / 2 + miss_ / 8);
    guess.kind = static_cast<std::uint32_t>(std::min<std::size_t>(c, 3));
    guess.hints[0] = NumberCoder::hint(log_of(slack), 0, 12);
    guess.hints[1] = NumberCoder::hint(log_of(guess.value), 0, 12);
    guess.hints[2] = has_ring ? NumberCoder::hint(log_of(miss_), 0, 12) / 2 : 15;
    const std::int64_t coded = numbers_.code(coder, numbers[c], guess);
    if (coded < 0 || coded > rest) return false;
    numbers[c] = static_cast<std::int32_t>(coded);
    rest -= coded;
    miss_ += (std::min(std::abs(16 * coded - guess.value), 16 * miss_ + 16) - miss_) / 16;
    miss_ = std::max<std::int64_t>(miss_, 16);
  }
  return true;
}

}  // namespace lodestone::detail

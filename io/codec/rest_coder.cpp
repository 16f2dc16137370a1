#include "codec/rest_coder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include <lodestone/core/detail/finite.h>

#include "base/ordered_bits.h"

namespace lodestone::detail {
namespace {

std::int64_t order_of(float value) { return ordered_bits(value); }

/// How far apart whole numbers lie.
float step_of(const AttributeSpec& spec) {
  const auto top = static_cast<float>(spec.highest());
  return spec.coding == AttributeCoding::Directions ? 1 / top : spec.range / top;
}

}  // namespace

RestCoder::Kind::Kind() : is_same({4 * 8}, 1) {}

RestCoder::RestCoder(float step, std::span<const AttributeSpec> attributes) {
  positions_.step = step;
  positions_.components.resize(3);
  for (const AttributeSpec& spec : attributes) {
    Kind& kind = attributes_.emplace_back();
    if (spec.is_exact()) continue;
    kind.step = step_of(spec);
    kind.components.resize(spec.component_count);
  }
}

/// The same number often is the same float. Else expected is a quarter of a step where all rests below half of one are
/// as likely, and what they were of late.
bool RestCoder::code(BitCoder& coder, Kind& kind, std::size_t c, std::int64_t number, float given, float& value) {
  Component& component = kind.components[c];
  const auto which = static_cast<std::uint32_t>(std::min<std::size_t>(c, 3));
  Remembered& last = component.remembered[static_cast<std::size_t>(number) % kRemembered];
  if (last.number == number) {
    const int is_same = kind.is_same.code(coder, order_of(given) == order_of(last.value) ? 1 : 0,
                                          std::array<std::uint32_t, 1>{which * 8 + component.past}, 0);
    component.past = (2 * component.past + static_cast<std::uint32_t>(is_same)) % 8;
    if (is_same != 0) {
      value = last.value;
      return true;
    }
  }
  const std::int64_t order = order_of(value);
  const int usual = log_of(4 * (order_of(value + kind.step) - order));
  NumberCoder::Guess guess;
  guess.scale = exp2_16(usual + component.ratio + 8);
  guess.kind = which;
  guess.hints[0] = NumberCoder::hint(component.ratio, -208, 16);
  guess.hints[1] = NumberCoder::hint(usual, 0, 32);
  const std::int64_t rest = kind.rests.code(coder, order_of(given) - order, guess);
  if (order + rest < 0 || order + rest > std::int64_t{std::numeric_limits<std::uint32_t>::max()}) return false;
  component.ratio += (log_of(16 * rest) - usual - component.ratio) / 8;
  value = from_ordered_bits(static_cast<std::uint32_t>(order + rest));
  last = {number, value};
  return true;
}

bool RestCoder::code_position(BitCoder& coder, const Vec3i& numbers, const Vec3f& given, Vec3f& position) {
  return code(coder, positions_, 0, numbers.x, given.x, position.x) &&
         code(coder, positions_, 1, numbers.y, given.y, position.y) &&
         code(coder, positions_, 2, numbers.z, given.z, position.z) && is_finite(position);
}

bool RestCoder::code_element(BitCoder& coder, std::size_t attribute, std::span<const std::int32_t> numbers,
                             std::span<const std::byte> given, std::span<std::byte> element) {
  Kind& kind = attributes_[attribute];
  for (std::size_t c = 0; c < kind.components.size(); ++c) {
    const auto component = element.subspan(c * sizeof(float), sizeof(float));
    float value = 0, wanted = 0;
    std::memcpy(&value, component.data(), sizeof value);
    if (!given.empty()) std::memcpy(&wanted, given.data() + c * sizeof wanted, sizeof wanted);
    if (!code(coder, kind, c, numbers[c], wanted, value)) return false;
    std::memcpy(component.data(), &value, sizeof value);
  }
  return true;
}

}  // namespace lodestone::detail

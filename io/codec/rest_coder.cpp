#include "codec/rest_coder.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include <lodestone/core/detail/finite.h>

#include "codec/fixed_point.h"

namespace lodestone::detail {
namespace {

/// Numbers all floats as they lie along the axis, those that are no number beyond the infinities; the two zeros apart.
std::int64_t order_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits ^ (bits >> 31U != 0 ? 0xFFFFFFFFU : 0x80000000U);
}
float float_of(std::int64_t order) {
  const auto bits = static_cast<std::uint32_t>(order);
  return std::bit_cast<float>(bits ^ (bits >> 31U != 0 ? 0x80000000U : 0xFFFFFFFFU));
}

/// How far apart whole numbers lie.
float step_of(const AttributeSpec& spec) {
  const auto top = static_cast<float>(spec.highest());
  return spec.coding == AttributeCoding::Directions ? 1 / top : spec.range / top;
}

}  // namespace

RestCoder::RestCoder(float step, std::span<const AttributeSpec> attributes) {
  positions_.step = step;
  positions_.ratios.assign(3, 0);
  for (const AttributeSpec& spec : attributes) {
    Kind& kind = attributes_.emplace_back();
    if (spec.is_exact()) continue;
    kind.step = step_of(spec);
    kind.ratios.assign(spec.component_count, 0);
  }
}

/// Expected is a quarter of a step where all rests below half of one are as likely, and what they were of late.
bool RestCoder::code(BitCoder& coder, Kind& kind, std::size_t component, float given, float& value) {
  const std::int64_t order = order_of(value);
  const int usual = log_of(4 * (order_of(value + kind.step) - order));
  int& ratio = kind.ratios[component];
  NumberCoder::Guess guess;
  guess.scale = exp2_16(usual + ratio + 8);
  guess.kind = static_cast<std::uint32_t>(std::min<std::size_t>(component, 3));
  guess.hints[0] = NumberCoder::hint(ratio, -208, 16);
  guess.hints[1] = NumberCoder::hint(usual, 0, 32);
  const std::int64_t rest = kind.numbers.code(coder, order_of(given) - order, guess);
  if (order + rest < 0 || order + rest > std::int64_t{std::numeric_limits<std::uint32_t>::max()}) return false;
  ratio += (log_of(16 * rest) - usual - ratio) / 8;
  value = float_of(order + rest);
  return true;
}

bool RestCoder::code_position(BitCoder& coder, const Vec3f& given, Vec3f& position) {
  return code(coder, positions_, 0, given.x, position.x) && code(coder, positions_, 1, given.y, position.y) &&
         code(coder, positions_, 2, given.z, position.z) && is_finite(position);
}

bool RestCoder::code_element(BitCoder& coder, std::size_t attribute, std::span<const std::byte> given,
                             std::span<std::byte> element) {
  Kind& kind = attributes_[attribute];
  for (std::size_t c = 0; c < kind.ratios.size(); ++c) {
    const auto component = element.subspan(c * sizeof(float), sizeof(float));
    float value = 0, wanted = 0;
    std::memcpy(&value, component.data(), sizeof value);
    if (!given.empty()) std::memcpy(&wanted, given.data() + c * sizeof wanted, sizeof wanted);
    if (!code(coder, kind, c, wanted, value)) return false;
    std::memcpy(component.data(), &value, sizeof value);
  }
  return true;
}

}  // namespace lodestone::detail

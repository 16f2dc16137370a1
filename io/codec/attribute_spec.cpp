#include "codec/attribute_spec.h"

#include <cmath>
#include <cstring>

namespace lodestone::detail {
namespace {

struct Limits {
  std::int64_t lowest, highest;
};

/// Unsigned numbers of 32 bits are moved down, so that all fit.
Limits integer_limits(ComponentType type) {
  switch (type) {
    case ComponentType::Int8:
      return {-128, 127};
    case ComponentType::UInt8:
      return {0, 255};
    case ComponentType::Int16:
      return {-32768, 32767};
    case ComponentType::UInt16:
      return {0, 65535};
    case ComponentType::UInt32:
    case ComponentType::Float32:
      break;
  }
  return {INT32_MIN, INT32_MAX};
}

template <class T>
void append_value(T value, std::vector<std::byte>& out) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

void append_integer(ComponentType type, std::int32_t number, std::vector<std::byte>& out) {
  switch (component_bytes(type)) {
    case 1:
      return append_value(static_cast<std::uint8_t>(number), out);
    case 2:
      return append_value(static_cast<std::uint16_t>(number), out);
    default:
      return append_value(static_cast<std::uint32_t>(number) ^ 0x80000000U, out);
  }
}

void append_direction(std::span<const std::int32_t> numbers, std::vector<std::byte>& out) {
  double square = 0;
  for (std::size_t c = 0; c < 3; ++c) square += static_cast<double>(numbers[c]) * static_cast<double>(numbers[c]);
  const double length = std::sqrt(square);
  for (std::size_t c = 0; c < 3; ++c) append_value(static_cast<float>(static_cast<double>(numbers[c]) / length), out);
  if (numbers.size() > 3) append_value(numbers[3] > 0 ? 1.0F : -1.0F, out);
}

}  // namespace

std::int64_t AttributeSpec::lowest() const {
  if (is_exact()) return integer_limits(type).lowest;
  return coding == AttributeCoding::Directions ? -highest() : 0;
}

std::int64_t AttributeSpec::highest() const {
  if (is_exact()) return integer_limits(type).highest;
  if (coding == AttributeCoding::Directions) return (std::int64_t{1} << (bits - 1)) - 1;
  return (std::int64_t{1} << bits) - 1;
}

void append_element(const AttributeSpec& spec, std::span<const std::int32_t> numbers, std::vector<std::byte>& out) {
  if (!spec.is_exact() && spec.coding == AttributeCoding::Directions) return append_direction(numbers, out);
  const double top = static_cast<double>(spec.highest());
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    if (spec.is_exact()) {
      append_integer(spec.type, numbers[c], out);
      continue;
    }
    const double value =
        static_cast<double>(spec.low[c]) + static_cast<double>(numbers[c]) * static_cast<double>(spec.range) / top;
    append_value(static_cast<float>(value), out);
  }
}

}  // namespace lodestone::detail

#include "attribute_values.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace lodestone::detail {
namespace {

template <class T>
void append_as_floats(const Attribute& attribute, float largest, std::vector<float>& values) {
  const std::size_t count = attribute.data.size() / sizeof(T);
  values.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, &attribute.data[i * sizeof(T)], sizeof(T));
    values[i] = attribute.normalized ? static_cast<float>(value) / largest : static_cast<float>(value);
  }
}

}  // namespace

std::vector<float> attribute_values(const Attribute& attribute) {
  std::vector<float> values;
  switch (attribute.type) {
    case ComponentType::Int8:
      append_as_floats<std::int8_t>(attribute, 127, values);
      break;
    case ComponentType::UInt8:
      append_as_floats<std::uint8_t>(attribute, 255, values);
      break;
    case ComponentType::Int16:
      append_as_floats<std::int16_t>(attribute, 32767, values);
      break;
    case ComponentType::UInt16:
      append_as_floats<std::uint16_t>(attribute, 65535, values);
      break;
    case ComponentType::UInt32:
      append_as_floats<std::uint32_t>(attribute, 4294967295.0F, values);
      break;
    case ComponentType::Float32:
      append_as_floats<float>(attribute, 1, values);
      break;
  }
  for (float& value : values)
    if (!std::isfinite(value)) value = 0;  // a file may hold anything; what is no number has no price
  return values;
}

}  // namespace lodestone::detail

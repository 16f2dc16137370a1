#include "mesh/vertex_color.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"

namespace lodestone::detail {
namespace {

constexpr double kLargest = 65535;
constexpr float kBrightest = 2;  // of colours that end at 1; rounding and bright light take some beyond

/// What is not a number is black.
double clamped(double value) { return value > 0 ? std::min(value, 1.0) : 0; }

double to_linear(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

double to_srgb(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace

Attribute color_attribute(std::span<const float> srgb, std::uint8_t component_count) {
  Attribute attribute{"COLOR_0", ComponentType::UInt16, component_count, true, {}};
  attribute.data.reserve(2 * srgb.size());
  for (std::size_t i = 0; i < srgb.size(); ++i) {
    const double value = clamped(static_cast<double>(srgb[i]));
    const double stored = i % component_count == 3 ? value : to_linear(value);
    append(attribute.data, static_cast<std::uint16_t>(std::lround(stored * kLargest)));
  }
  return attribute;
}

float color_range(std::span<const float> components) {
  return std::any_of(components.begin(), components.end(), [](float c) { return c > kBrightest; }) ? 255.0F : 1.0F;
}

std::uint8_t srgb_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(255 * to_srgb(clamped(static_cast<double>(linear)))));
}

std::uint8_t share_byte(float share) {
  return static_cast<std::uint8_t>(std::lround(255 * clamped(static_cast<double>(share))));
}

}  // namespace lodestone::detail

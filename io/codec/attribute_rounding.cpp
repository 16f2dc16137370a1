#include "codec/attribute_rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

namespace lodestone::detail {
namespace {

constexpr double kUnitTolerance = 0.05;

/// Whether all elements are unit vectors, the fourth component, if there is one, 1 or −1.
bool are_directions(const Attribute& attribute, const std::vector<float>& values) {
  const std::size_t size = attribute.component_count;
  for (std::size_t i = 0; i < values.size(); i += size) {
    double square = 0;
    for (std::size_t c = 0; c < 3; ++c)
      square += static_cast<double>(values[i + c]) * static_cast<double>(values[i + c]);
    if (!(std::abs(square - 1) < kUnitTolerance)) return false;
    if (size > 3 && std::abs(values[i + 3]) != 1.0F) return false;
  }
  return true;
}

/// Each component's least value, and the largest extent of any.
void find_grid(const std::vector<float>& values, AttributeSpec& spec) {
  std::vector<float> high(spec.component_count, -std::numeric_limits<float>::infinity());
  spec.low.assign(spec.component_count, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    float &low = spec.low[i % spec.component_count], &most = high[i % spec.component_count];
    low = std::min(low, values[i]);
    most = std::max(most, values[i]);
  }
  double range = 0;
  for (std::size_t c = 0; c < spec.component_count; ++c) {
    if (spec.low[c] > high[c]) spec.low[c] = high[c] = 0;
    range = std::max(range, static_cast<double>(high[c]) - static_cast<double>(spec.low[c]));
  }
  // Rounded up, so that the largest value is within; less where that would go beyond what floats can say.
  constexpr float kLargest = std::numeric_limits<float>::max();
  spec.range = static_cast<float>(std::min(range, static_cast<double>(kLargest)));
  if (static_cast<double>(spec.range) < range) spec.range = std::nextafter(spec.range, kLargest);
  for (const float low : spec.low)
    while (!std::isfinite(low + spec.range)) spec.range *= 0.5F;
}

std::int32_t integer_component(ComponentType type, const std::byte* at) {
  const auto load = [&](auto value) {
    std::memcpy(&value, at, sizeof value);
    return value;
  };
  switch (type) {
    case ComponentType::Int8:
      return load(std::int8_t{});
    case ComponentType::UInt8:
      return load(std::uint8_t{});
    case ComponentType::Int16:
      return load(std::int16_t{});
    case ComponentType::UInt16:
      return load(std::uint16_t{});
    case ComponentType::UInt32:
    case ComponentType::Float32:
      break;
  }
  return static_cast<std::int32_t>(load(std::uint32_t{}) ^ 0x80000000U);
}

void round_direction(const float* values, std::int64_t size, std::int32_t* numbers) {
  std::size_t top = 2;
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += std::abs(static_cast<double>(values[c]));
    if (std::abs(values[c]) > std::abs(values[top])) top = c;
  }
  std::int64_t rest = size;
  for (std::size_t c = 0; c < 3; ++c) {
    if (c == top) continue;
    const double steps = static_cast<double>(values[c]) / sum * static_cast<double>(size);
    numbers[c] = static_cast<std::int32_t>(
        std::clamp(std::floor(steps + 0.5), -static_cast<double>(rest), static_cast<double>(rest)));
    rest -= std::abs(numbers[c]);
  }
  numbers[top] = static_cast<std::int32_t>(values[top] < 0 ? -rest : rest);
}

AttributeSpec choose_spec(const Attribute& attribute, const CompactOptions& options) {
  AttributeSpec spec;
  spec.name = attribute.name;
  spec.type = attribute.type;
  spec.component_count = attribute.component_count;
  spec.normalized = attribute.normalized;
  const std::string_view name = attribute.name;
  const bool is_texture = name.starts_with("TEXCOORD_") && attribute.component_count == 2 &&
                          attribute.type != ComponentType::UInt32;  // glTF has none of these either
  if (is_texture) spec.coding = AttributeCoding::Texture;
  if (attribute.type != ComponentType::Float32) return spec;
  const std::vector<float> values = attribute_values(attribute);
  const bool is_direction =
      (name == "NORMAL" && attribute.component_count == 3) || (name == "TANGENT" && attribute.component_count == 4);
  if (is_direction && are_directions(attribute, values)) {
    spec.coding = AttributeCoding::Directions;
    spec.bits = static_cast<std::uint8_t>(options.normal_bits);
    return spec;
  }
  spec.bits = static_cast<std::uint8_t>(is_texture ? options.texture_bits : options.other_bits);
  find_grid(values, spec);
  return spec;
}

std::vector<std::int32_t> rounded_alone(const Attribute& attribute, const AttributeSpec& spec) {
  const std::size_t size = spec.component_count;
  const std::size_t count = attribute.data.size() / component_bytes(spec.type);
  std::vector<std::int32_t> numbers(count);
  if (spec.is_exact()) {
    for (std::size_t i = 0; i < count; ++i)
      numbers[i] = integer_component(spec.type, attribute.data.data() + i * component_bytes(spec.type));
    return numbers;
  }
  const std::vector<float> values = attribute_values(attribute);
  if (spec.coding == AttributeCoding::Directions) {
    for (std::size_t i = 0; i < count; i += size) {
      round_direction(&values[i], spec.highest(), &numbers[i]);
      if (size > 3) numbers[i + 3] = values[i + 3] > 0 ? 1 : -1;
    }
    return numbers;
  }
  const double top = static_cast<double>(spec.highest());
  for (std::size_t i = 0; i < count; ++i) {
    const double low = static_cast<double>(spec.low[i % size]), range = static_cast<double>(spec.range);
    const double steps = range > 0 && !std::isnan(values[i]) ? (static_cast<double>(values[i]) - low) / range * top : 0;
    numbers[i] = static_cast<std::int32_t>(std::floor(std::clamp(steps, 0.0, top) + 0.5));
  }
  return numbers;
}

bool is_weights(const Attribute& attribute) {
  return attribute.name.starts_with("WEIGHTS_") && attribute.type == ComponentType::Float32;
}

/// Whether the weights of each wedge are not negative and add up to 1, over all attributes of them.
bool add_up(std::span<const Attribute> attributes) {
  std::vector<double> sums;
  for (const Attribute& attribute : attributes) {
    if (!is_weights(attribute)) continue;
    const std::vector<float> values = attribute_values(attribute);
    sums.resize(values.size() / attribute.component_count, 0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] >= 0)) return false;
      sums[i / attribute.component_count] += static_cast<double>(values[i]);
    }
  }
  return std::all_of(sums.begin(), sums.end(), [](double sum) { return std::abs(sum - 1) < kUnitTolerance; });
}

/// Rounds weights down, and those up that lie highest above, as many as are missing.
void round_weights(std::span<const Attribute> attributes, std::span<const AttributeSpec> specs,
                   std::vector<std::vector<std::int32_t>>& numbers) {
  struct Share {
    std::size_t attribute, at;
    double above;
  };
  std::vector<std::vector<float>> values(attributes.size());
  std::size_t wedge_count = 0;
  for (std::size_t a = 0; a < attributes.size(); ++a) {
    if (specs[a].coding != AttributeCoding::Weights) continue;
    values[a] = attribute_values(attributes[a]);
    numbers[a].resize(values[a].size());
    wedge_count = values[a].size() / specs[a].component_count;
  }
  std::vector<Share> shares;
  for (std::size_t w = 0; w < wedge_count; ++w) {
    shares.clear();
    double sum = 0;
    std::int64_t rest = 0;
    for (std::size_t a = 0; a < attributes.size(); ++a)
      for (std::size_t c = 0; c < specs[a].component_count && !values[a].empty(); ++c) {
        shares.push_back({a, w * specs[a].component_count + c, 0});
        sum += static_cast<double>(values[a][shares.back().at]);
        rest = specs[a].highest();
      }
    const double top = static_cast<double>(rest);
    for (Share& share : shares) {
      const double exact = static_cast<double>(values[share.attribute][share.at]) / sum * top;
      const auto below = static_cast<std::int32_t>(std::floor(exact));
      numbers[share.attribute][share.at] = below;
      share.above = exact - static_cast<double>(below);
      rest -= below;
    }
    std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.above > b.above; });
    for (std::size_t i = 0; i < shares.size() && rest > 0; ++i, --rest) ++numbers[shares[i].attribute][shares[i].at];
  }
}

}  // namespace

std::vector<AttributeSpec> choose_specs(std::span<const Attribute> attributes, const CompactOptions& options) {
  const bool has_weights = add_up(attributes);
  std::vector<AttributeSpec> specs;
  for (const Attribute& attribute : attributes) {
    AttributeSpec& spec = specs.emplace_back(choose_spec(attribute, options));
    if (!has_weights || !is_weights(attribute)) continue;
    spec.coding = AttributeCoding::Weights;
    spec.bits = static_cast<std::uint8_t>(options.weight_bits);
    spec.low.assign(spec.component_count, 0);
    spec.range = 1;
  }
  return specs;
}

std::vector<std::vector<std::int32_t>> rounded(std::span<const Attribute> attributes,
                                               std::span<const AttributeSpec> specs) {
  std::vector<std::vector<std::int32_t>> numbers(attributes.size());
  for (std::size_t a = 0; a < attributes.size(); ++a)
    if (specs[a].coding != AttributeCoding::Weights) numbers[a] = rounded_alone(attributes[a], specs[a]);
  round_weights(attributes, specs, numbers);
  return numbers;
}

}  // namespace lodestone::detail

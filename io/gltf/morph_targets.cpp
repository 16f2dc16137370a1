#include "gltf/morph_targets.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

constexpr std::string_view kPrefix = "TARGET_";

bool shows(std::span<const float> weights, std::size_t target) {
  return target < weights.size() && weights[target] != 0;
}

}  // namespace

MorphTargets::MorphTargets(std::span<const Attribute> attributes, std::string_view semantic) {
  const std::string suffix = text(':', semantic);
  for (const Attribute& attribute : attributes) {
    std::string_view name = attribute.name;
    if (!name.starts_with(kPrefix) || !name.ends_with(suffix)) continue;
    if (attribute.type != ComponentType::Float32 || attribute.component_count != 3) continue;
    name.remove_prefix(kPrefix.size());
    name.remove_suffix(suffix.size());
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error != std::errc{} || end != name.data() + name.size()) continue;
    targets_.push_back({number, &attribute});
    count_ = std::max(count_, number + 1);
  }
}

std::size_t MorphTargets::count_shown(std::span<const float> weights) const {
  return static_cast<std::size_t>(std::count_if(targets_.begin(), targets_.end(),
                                                [&](const Target& target) { return shows(weights, target.number); }));
}

void MorphTargets::move(std::span<Vec3> points, std::span<const float> weights) const {
  for (const Target& target : targets_) {
    if (!shows(weights, target.number)) continue;
    const double weight = weights[target.number];
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vec3f displacement;
      std::memcpy(&displacement, target.displacements->data.data() + i * sizeof displacement, sizeof displacement);
      const Vec3 moved = points[i] + weight * Vec3(displacement);
      if (std::isfinite(squared_length(moved))) points[i] = moved;
    }
  }
}

}  // namespace lodestone::detail

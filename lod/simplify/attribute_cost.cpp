// The idea of pricing attributes with the geometry is that of Hoppe: New quadric metric for simplifying meshes with
// appearance attributes (Visualization 1999); here every difference becomes a length on the surface, so that it can be
// added to distances without a factor that depends on the model.

#include "simplify/attribute_cost.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include <lodestone/core/detail/finite_values.h>

namespace lodestone::detail {
namespace {

/// Of the morph target that an attribute belongs to.
double reach_of(std::string_view name, std::span<const double> reaches) {
  std::size_t number = reaches.size();
  name.remove_prefix(std::string_view("TARGET_").size());
  std::from_chars(name.data(), name.data() + name.size(), number);
  return number < reaches.size() ? reaches[number] : 1;
}

}  // namespace

AttributeCost::AttributeCost(const Mesh& mesh, const AttributeWeights& weights) : textures_(mesh) {
  std::size_t texture = 0;
  for (const Attribute& attribute : mesh.attributes) {
    const std::string_view name = attribute.name;
    if (name == "NORMAL" && attribute.component_count == 3) add_channel(attribute, Kind::Direction, weights.normal);
    if (TextureAreas::is_texture(attribute)) add_texture(texture++, weights.texcoord);
    if (name.starts_with("COLOR_")) add_channel(attribute, Kind::Value, weights.color);
    if (name.starts_with("JOINTS_")) add_skin(mesh, attribute, weights.skin);
    if (name.starts_with("TARGET_") && name.ends_with(":POSITION"))
      add_channel(attribute, Kind::Displacement, weights.target * reach_of(name, weights.target_reach));
  }
}

void AttributeCost::add_channel(const Attribute& attribute, Kind kind, double weight) {
  if (weight > 0) channels_.push_back({kind, weight, 0, attribute.component_count, finite_values(attribute)});
}

void AttributeCost::add_texture(std::size_t texture, double weight) {
  if (weight > 0) channels_.push_back({Kind::Texture, weight, texture, 2, {}});
}

void AttributeCost::add_skin(const Mesh& mesh, const Attribute& joints, double weight) {
  const std::string wanted = "WEIGHTS_" + joints.name.substr(7);
  const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                  [&](const Attribute& attribute) { return attribute.name == wanted; });
  if (weight <= 0 || found == mesh.attributes.end() || found->component_count != joints.component_count) return;
  skin_.push_back({weight, joints.component_count, finite_values(joints), finite_values(*found)});
}

AttributeScale AttributeCost::scale(Index center, std::span<const Index> polygon, bool wraps, double area) const {
  AttributeScale scale;
  scale.radius = std::sqrt(area);
  const std::size_t faces = wraps ? polygon.size() : polygon.size() - 1;
  for (std::size_t t = 0; t < texture_count(); ++t) {
    double positive = 0;
    double negative = 0;
    for (std::size_t i = 0; i < faces; ++i) {
      const double doubled = texture_area(t, center, polygon[i], polygon[i + 1 < polygon.size() ? i + 1 : 0]);
      (doubled > 0 ? positive : negative) += 0.5 * std::abs(doubled);
    }
    const double sum = positive + negative;
    scale.texture.push_back(sum > 0 ? std::sqrt(area / sum) : 0);
    scale.orientation.push_back(negative == 0 && positive > 0 ? 1 : positive == 0 && negative > 0 ? -1 : 0);
  }
  return scale;
}

double AttributeCost::squared_difference(Index wedge, const Place& place, const AttributeScale& scale) const {
  double sum = 0;
  for (const Channel& channel : channels_) {
    double unit = scale.radius;
    if (channel.kind == Kind::Texture) unit = scale.texture[channel.texture];
    if (channel.kind == Kind::Displacement) unit = 1;
    const double length = channel.weight * unit * difference(channel, wedge, place);
    sum += length * length;
  }
  for (const Skin& skin : skin_) {
    const double length = skin.weight * scale.radius * difference(skin, wedge, place);
    sum += length * length;
  }
  return sum;
}

bool AttributeCost::turns_texture(Index a, Index b, Index c, const AttributeScale& scale) const {
  for (std::size_t i = 0; i < texture_count(); ++i) {
    const int orientation = scale.orientation[i];
    if (orientation != 0 && !(orientation * texture_area(i, a, b, c) > 0)) return true;
  }
  return false;
}

double AttributeCost::difference(const Channel& channel, Index wedge, const Place& place) const {
  const std::vector<float>& values =
      channel.kind == Kind::Texture ? textures_.coordinates(channel.texture) : channel.values;
  std::array<double, 4> there{};
  const std::size_t width = std::min<std::size_t>(channel.width, there.size());
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < width; ++i)
      there[i] += place.weights[k] * static_cast<double>(values[place.wedges[k] * channel.width + i]);
  if (channel.kind == Kind::Direction) {
    const double length = std::sqrt(there[0] * there[0] + there[1] * there[1] + there[2] * there[2]);
    for (std::size_t i = 0; i < 3 && length > 0; ++i) there[i] /= length;
  }
  double sum = 0;
  for (std::size_t i = 0; i < width; ++i) {
    const double d = there[i] - static_cast<double>(values[wedge * channel.width + i]);
    sum += d * d;
  }
  return std::sqrt(sum);
}

/// The share of weight that goes to other joints.
double AttributeCost::difference(const Skin& skin, Index wedge, const Place& place) {
  std::array<std::pair<float, double>, 64> share{};  // joint, signed weight
  std::size_t count = 0;
  const auto add = [&](Index of, double factor) {
    for (std::size_t i = 0; i < skin.width; ++i) {
      const float joint = skin.joints[of * skin.width + i];
      const double weight = factor * static_cast<double>(skin.weights[of * skin.width + i]);
      std::size_t at = 0;
      while (at < count && share[at].first != joint) ++at;
      if (at == share.size()) return;
      if (at == count) share[count++] = {joint, 0};
      share[at].second += weight;
    }
  };
  add(wedge, 1);
  for (std::size_t k = 0; k < 3; ++k) add(place.wedges[k], -place.weights[k]);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += std::abs(share[i].second);
  return 0.5 * sum;
}

}  // namespace lodestone::detail

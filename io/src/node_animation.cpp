#include "node_animation.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <string>
#include <string_view>

namespace lodestone::detail {
namespace {

using Property = AnimationCurve::Property;
using Interpolation = AnimationCurve::Interpolation;

// Of an even choice of an animation's key frames.
constexpr std::size_t kEvenChoice = 16;

bool read_property(std::string_view name, AnimationCurve& curve) {
  if (name == "translation") curve.property = Property::Translation;
  if (name == "rotation") curve.property = Property::Rotation;
  if (name == "scale") curve.property = Property::Scale;
  curve.width = name == "rotation" ? 4 : 3;
  return name == "translation" || name == "rotation" || name == "scale";
}

constexpr std::string_view kNodes = "/nodes/";

/// Reads "/nodes/3/scale".
bool read_pointer(std::string_view pointer, AnimationCurve& curve) {
  if (!pointer.starts_with(kNodes)) return false;
  pointer.remove_prefix(kNodes.size());
  const std::size_t slash = std::min(pointer.find('/'), pointer.size());
  const auto [end, error] = std::from_chars(pointer.data(), pointer.data() + slash, curve.node);
  if (error != std::errc{} || end != pointer.data() + slash || slash == pointer.size()) return false;
  return read_property(pointer.substr(slash + 1), curve);
}

bool read_target(const Json& target, AnimationCurve& curve) {
  if (const Json* extension = GltfDocument::extension(target, "KHR_animation_pointer"))
    return read_pointer(string_member(*extension, "pointer"), curve);
  const auto node = size_member(target, "node", "");
  if (!node) return false;
  curve.node = *node;
  return read_property(string_member(target, "path"), curve);
}

std::vector<float> read_floats(const GltfDocument& document, const Json& sampler, const char* key) {
  const auto index = size_member(sampler, key, "");
  if (!index) return {};
  const auto data = document.accessor(*index);
  return data ? to_floats(*data) : std::vector<float>();
}

bool all_finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

bool read_sampler(const GltfDocument& document, const Json& sampler, AnimationCurve& curve) {
  const std::string name = string_member(sampler, "interpolation");
  if (name == "STEP") curve.interpolation = Interpolation::Step;
  if (name == "CUBICSPLINE") curve.interpolation = Interpolation::Cubic;
  curve.times = read_floats(document, sampler, "input");
  curve.values = read_floats(document, sampler, "output");
  const std::size_t values = curve.times.size() * (curve.interpolation == Interpolation::Cubic ? 3 : 1);
  return values > 0 && curve.values.size() == values * curve.width && all_finite(curve.times) &&
         all_finite(curve.values) && std::is_sorted(curve.times.begin(), curve.times.end());
}

double largest(double x, double y, double z) { return std::max({std::abs(x), std::abs(y), std::abs(z)}); }

/// The key frame at which a node grows most.
struct Peak {
  double growth = 1;
  float time = 0;
};

Peak find_peak(const AnimationCurve& curve, const LocalPlace& at_rest) {
  Peak peak;
  const double rest = largest(at_rest.scale.x, at_rest.scale.y, at_rest.scale.z);
  for (std::size_t i = 0; i < curve.times.size(); ++i) {
    const auto value = curve.key(i);
    const double scale = largest(double{value[0]}, double{value[1]}, double{value[2]});
    if (scale > peak.growth * rest) peak = {rest > 0 ? scale / rest : HUGE_VAL, curve.times[i]};
  }
  return peak;
}

/// Sorts numbers and leaves each once.
void make_unique(std::vector<float>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Times of peaks, the highest first, each once.
std::vector<float> find_peak_times(std::span<const AnimationCurve> curves, std::span<const LocalPlace> at_rest) {
  std::vector<Peak> peaks;
  for (const AnimationCurve& curve : curves)
    if (curve.property == Property::Scale) {
      const Peak peak = find_peak(curve, at_rest[curve.node]);
      if (peak.growth > 1) peaks.push_back(peak);
    }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.growth > b.growth; });
  std::vector<float> times;
  std::set<float> seen;
  for (const Peak& peak : peaks)
    if (seen.insert(peak.time).second) times.push_back(peak.time);
  return times;
}

/// The value of a curve at a time.
std::array<double, 4> value_at(const AnimationCurve& curve, float time) {
  const auto after = std::upper_bound(curve.times.begin(), curve.times.end(), time);
  const auto right = std::min(static_cast<std::size_t>(after - curve.times.begin()), curve.times.size() - 1);
  const std::size_t left = after == curve.times.begin() ? 0 : static_cast<std::size_t>(after - curve.times.begin()) - 1;
  const double span = static_cast<double>(curve.times[right]) - static_cast<double>(curve.times[left]);
  const double t = span > 0 ? (static_cast<double>(time) - static_cast<double>(curve.times[left])) / span : 0;
  std::array<double, 4> value{};
  for (std::size_t i = 0; i < curve.width; ++i) {
    const double a = curve.key(left)[i], b = curve.key(right)[i];
    value[i] = curve.interpolation == Interpolation::Step ? a : a + t * (b - a);
    if (curve.interpolation != Interpolation::Cubic) continue;
    const double out = span * static_cast<double>(curve.values[(3 * left + 2) * curve.width + i]);
    const double in = span * static_cast<double>(curve.values[3 * right * curve.width + i]);
    const double t2 = t * t, t3 = t2 * t;
    value[i] = (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * out + (3 * t2 - 2 * t3) * b + (t3 - t2) * in;
  }
  return value;
}

}  // namespace

std::vector<AnimationCurve> read_animation(const GltfDocument& document, std::size_t index, std::size_t& most_numbers) {
  std::vector<AnimationCurve> curves;
  const auto animation = document.element("animations", "animation", index);
  const Json* channels = animation ? find_member(**animation, "channels") : nullptr;
  const Json* samplers = animation ? find_member(**animation, "samplers") : nullptr;
  if (channels == nullptr || !channels->is_array() || samplers == nullptr || !samplers->is_array()) return curves;
  for (const Json& channel : *channels) {
    AnimationCurve curve;
    const Json* target = find_member(channel, "target");
    const auto sampler = size_member(channel, "sampler", "");
    if (target == nullptr || !sampler || *sampler >= samplers->size() || !read_target(*target, curve)) continue;
    if (curve.node >= document.count("nodes")) continue;
    const bool is_good = read_sampler(document, (*samplers)[*sampler], curve);
    const std::size_t numbers = curve.times.size() + curve.values.size();
    if (numbers > most_numbers) most_numbers = 0;
    if (most_numbers == 0) break;
    most_numbers -= numbers;
    if (is_good) curves.push_back(std::move(curve));
  }
  return curves;
}

std::vector<float> choose_key_frames(std::span<const AnimationCurve> curves, std::span<const LocalPlace> at_rest,
                                     std::size_t most) {
  std::vector<float> times = find_peak_times(curves, at_rest), keys;
  if (times.size() > most) times.resize(most);
  for (const AnimationCurve& curve : curves) keys.insert(keys.end(), curve.times.begin(), curve.times.end());
  make_unique(keys);
  const std::size_t count = std::min({most - times.size(), keys.size(), kEvenChoice});
  for (std::size_t i = 0; i < count; ++i) times.push_back(keys[count > 1 ? i * (keys.size() - 1) / (count - 1) : 0]);
  make_unique(times);
  return times;
}

void apply(std::span<const AnimationCurve> curves, float time, std::span<LocalPlace> nodes) {
  for (const AnimationCurve& curve : curves) {
    LocalPlace& node = nodes[curve.node];
    const std::array<double, 4> value = value_at(curve, time);
    if (curve.property == Property::Translation) node.translation = {value[0], value[1], value[2]};
    if (curve.property == Property::Scale) node.scale = {value[0], value[1], value[2]};
    if (curve.property != Property::Rotation) continue;
    const double norm = std::hypot(std::hypot(value[0], value[1]), std::hypot(value[2], value[3]));
    if (norm > 0) node.rotation = {value[0] / norm, value[1] / norm, value[2] / norm, value[3] / norm};
  }
}

}  // namespace lodestone::detail

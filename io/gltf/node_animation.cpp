#include "gltf/node_animation.h"

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
  if (name == "weights") curve.property = Property::Weights;
  curve.width = name == "rotation" ? 4 : name == "weights" ? 0 : 3;
  return name == "translation" || name == "rotation" || name == "scale" || name == "weights";
}

/// Takes "/3" or "/3/…" from the beginning of a text.
bool take_number(std::string_view& text, std::size_t& number) {
  if (!text.starts_with('/')) return false;
  const std::size_t end = std::min(text.find('/', 1), text.size());
  const auto [stop, error] = std::from_chars(text.data() + 1, text.data() + end, number);
  if (error != std::errc{} || stop != text.data() + end) return false;
  text.remove_prefix(end);
  return true;
}

constexpr std::string_view kNodes = "/nodes", kMeshes = "/meshes", kWeights = "/weights";

/// Reads "/nodes/3/scale", "/nodes/3/weights", "/meshes/3/weights/0".
bool read_pointer(std::string_view pointer, AnimationCurve& curve) {
  const bool of_mesh = pointer.starts_with(kMeshes);
  if (!of_mesh && !pointer.starts_with(kNodes)) return false;
  pointer.remove_prefix(of_mesh ? kMeshes.size() : kNodes.size());
  if (!take_number(pointer, of_mesh ? curve.mesh : curve.node) || !pointer.starts_with('/')) return false;
  if (!pointer.starts_with(kWeights)) return !of_mesh && read_property(pointer.substr(1), curve);
  curve.property = Property::Weights;
  pointer.remove_prefix(kWeights.size());
  if (!take_number(pointer, curve.target)) return pointer.empty();
  curve.width = 1;
  return pointer.empty();
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
  const bool has_all_weights = curve.property == Property::Weights && curve.width == 0;
  if (has_all_weights && values > 0) curve.width = curve.values.size() / values;
  return values > 0 && curve.values.size() == values * curve.width && all_finite(curve.times) &&
         all_finite(curve.values) && std::is_sorted(curve.times.begin(), curve.times.end());
}

double largest(double x, double y, double z) { return std::max({std::abs(x), std::abs(y), std::abs(z)}); }

/// The key frame at which a node grows most.
struct Peak {
  double growth = 1;
  float time = 0;
};

Peak find_growth(const AnimationCurve& curve, const LocalPlace& at_rest) {
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
      const Peak peak = find_growth(curve, at_rest[curve.node]);
      if (peak.growth > 1) peaks.push_back(peak);
    }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.growth > b.growth; });
  std::vector<float> times;
  std::set<float> seen;
  for (const Peak& peak : peaks)
    if (seen.insert(peak.time).second) times.push_back(peak.time);
  return times;
}

/// Two neighbouring key frames, and a place between them.
struct KeySpan {
  std::size_t left = 0, right = 0;
  double length = 0;  // in time
  double t = 0;       // 0 at the left one, 1 at the right one
};

KeySpan find_span(const AnimationCurve& curve, float time) {
  const auto after = std::upper_bound(curve.times.begin(), curve.times.end(), time) - curve.times.begin();
  KeySpan span;
  span.right = std::min(static_cast<std::size_t>(after), curve.times.size() - 1);
  span.left = after == 0 ? 0 : static_cast<std::size_t>(after) - 1;
  span.length = static_cast<double>(curve.times[span.right]) - static_cast<double>(curve.times[span.left]);
  if (span.length > 0) span.t = (static_cast<double>(time) - static_cast<double>(curve.times[span.left])) / span.length;
  return span;
}

/// Coefficients of a number between two key frames, by powers of t.
std::array<double, 4> polynomial(const AnimationCurve& curve, const KeySpan& span, std::size_t number) {
  const double a = curve.key(span.left)[number], b = curve.key(span.right)[number];
  if (curve.interpolation == Interpolation::Step) return {a, 0, 0, 0};
  if (curve.interpolation == Interpolation::Linear) return {a, b - a, 0, 0};
  const double out = span.length * static_cast<double>(curve.values[(3 * span.left + 2) * curve.width + number]);
  const double in = span.length * static_cast<double>(curve.values[3 * span.right * curve.width + number]);
  return {a, out, 3 * (b - a) - 2 * out - in, 2 * (a - b) + out + in};
}

double value_of(const std::array<double, 4>& p, double t) { return p[0] + t * (p[1] + t * (p[2] + t * p[3])); }

/// Where the derivative of a cubic polynomial is 0; no number where there is no such place.
std::array<double, 2> turning_points(const std::array<double, 4>& p) {
  const double a = 3 * p[3], half = p[2], c = p[1];
  const double q = -(half + std::copysign(std::sqrt(half * half - a * c), half));
  return {q / a, c / q};
}

}  // namespace

double value_at(const AnimationCurve& curve, float time, std::size_t number) {
  const KeySpan span = find_span(curve, time);
  return value_of(polynomial(curve, span, number), span.t);
}

CurvePeak find_peak(const AnimationCurve& curve, std::size_t number) {
  CurvePeak peak;
  const auto look_at = [&](double value, double time) {
    if (std::abs(value) > peak.value) peak = {std::abs(value), static_cast<float>(time)};
  };
  for (std::size_t i = 0; i < curve.times.size(); ++i) {
    look_at(curve.key(i)[number], curve.times[i]);
    if (curve.interpolation != Interpolation::Cubic || i + 1 == curve.times.size()) continue;
    const double begin = curve.times[i], length = static_cast<double>(curve.times[i + 1]) - begin;
    const std::array<double, 4> cubic = polynomial(curve, {i, i + 1, length, 0}, number);
    for (const double t : turning_points(cubic))
      if (t > 0 && t < 1) look_at(value_of(cubic, t), begin + t * length);
  }
  return peak;
}

Animation read_animation(const GltfDocument& document, std::size_t index, std::size_t& most_numbers) {
  Animation read;
  const auto animation = document.element("animations", "animation", index);
  const Json* channels = animation ? find_member(**animation, "channels") : nullptr;
  const Json* samplers = animation ? find_member(**animation, "samplers") : nullptr;
  if (channels == nullptr || !channels->is_array() || samplers == nullptr || !samplers->is_array()) return read;
  for (const Json& channel : *channels) {
    AnimationCurve curve;
    const Json* target = find_member(channel, "target");
    const auto sampler = size_member(channel, "sampler", "");
    if (target == nullptr || !sampler || *sampler >= samplers->size() || !read_target(*target, curve)) continue;
    if (curve.mesh == kNoNode && curve.node >= document.count("nodes")) continue;
    const bool is_good = read_sampler(document, (*samplers)[*sampler], curve);
    const std::size_t numbers = curve.times.size() + curve.values.size();
    if (numbers > most_numbers) most_numbers = 0;
    if (most_numbers == 0) break;
    most_numbers -= numbers;
    if (is_good) (curve.property == Property::Weights ? read.weights : read.places).push_back(std::move(curve));
  }
  return read;
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
    const KeySpan span = find_span(curve, time);
    std::array<double, 4> value{};
    for (std::size_t i = 0; i < curve.width; ++i) value[i] = value_of(polynomial(curve, span, i), span.t);
    if (curve.property == Property::Translation) node.translation = {value[0], value[1], value[2]};
    if (curve.property == Property::Scale) node.scale = {value[0], value[1], value[2]};
    if (curve.property != Property::Rotation) continue;
    const double norm = std::hypot(std::hypot(value[0], value[1]), std::hypot(value[2], value[3]));
    if (norm > 0) node.rotation = {value[0] / norm, value[1] / norm, value[2] / norm, value[3] / norm};
  }
}

}  // namespace lodestone::detail

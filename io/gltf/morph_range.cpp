#include "gltf/morph_range.h"

#include <algorithm>
#include <cmath>

namespace lodestone::detail {
namespace {

// Files may have any number of nodes that show a mesh of many targets: what is kept of all their weights together.
constexpr std::size_t kMostWeights = 16'000'000;
constexpr std::size_t kMostPeaks = 16;  // of one node or mesh

// What is larger by rounding alone is no new peak.
constexpr float kLargerPeak = 1.001F;

TargetWeights read_weights(const Json& holder) {
  TargetWeights weights;
  const Json* list = find_member(holder, "weights");
  if (list == nullptr || !list->is_array()) return weights;
  for (const Json& item : *list) {
    const float weight = item.is_number() ? item.get<float>() : 0;
    weights.push_back(std::isfinite(weight) ? weight : 0);
  }
  return weights;
}

/// Of the primitive that has most: all should have as many.
std::size_t count_targets(const Json& mesh) {
  std::size_t most = 0;
  const Json* primitives = find_member(mesh, "primitives");
  if (primitives == nullptr || !primitives->is_array()) return 0;
  for (const Json& primitive : *primitives) {
    const Json* targets = find_member(primitive, "targets");
    if (targets != nullptr && targets->is_array()) most = std::max(most, targets->size());
  }
  return most;
}

TargetWeights without_signs(TargetWeights weights) {
  for (float& weight : weights) weight = std::abs(weight);
  return weights;
}

}  // namespace

TargetWeights weights_at_rest(const GltfDocument& document, const Json& node, std::size_t mesh) {
  if (find_member(node, "weights") != nullptr) return read_weights(node);
  const auto shown = document.element("meshes", "mesh", mesh);
  return shown ? read_weights(**shown) : TargetWeights();
}

void MorphRanges::add_node(std::size_t index, const Json& node) {
  const auto mesh = size_member(node, "mesh", "");
  const auto shown = mesh ? document_.element("meshes", "mesh", *mesh) : fail(ErrorCode::Malformed, "");
  if (!shown) return;
  Entry& of_mesh = entries_[{true, *mesh}];
  if (of_mesh.target_count == 0) {
    of_mesh.target_count = count_targets(**shown);
    of_mesh.range.at_rest = read_weights(**shown);
    of_mesh.range.largest = without_signs(of_mesh.range.at_rest);
  }
  if (of_mesh.target_count == 0) return;
  Entry& of_node = entries_[{false, index}];
  of_node.target_count = of_mesh.target_count;
  if (find_member(node, "weights") == nullptr) of_node.mesh = *mesh;
  of_node.range.at_rest = read_weights(node);
  of_node.range.largest = without_signs(of_node.range.at_rest);
}

MorphRanges::Owner MorphRanges::owner_of(const AnimationCurve& curve) {
  return curve.mesh != kNoNode ? Owner(true, curve.mesh) : Owner(false, curve.node);
}

/// Whether a curve moves one target, or all that there are.
bool MorphRanges::fits(const AnimationCurve& curve) const {
  const auto entry = entries_.find(owner_of(curve));
  if (entry == entries_.end() || curve.width == 0) return false;
  const std::size_t count = entry->second.target_count;
  return curve.target < count && (curve.width == 1 || curve.width == count);
}

bool MorphRanges::spend(std::size_t numbers) {
  if (numbers > kMostWeights - spent_) return false;
  spent_ += numbers;
  return true;
}

void MorphRanges::add_animation(std::span<const AnimationCurve> curves) {
  std::map<Owner, std::vector<const AnimationCurve*>> by_owner;
  for (const AnimationCurve& curve : curves)
    if (fits(curve)) by_owner[owner_of(curve)].push_back(&curve);
  for (const auto& [owner, own] : by_owner) {
    MorphRange& range = entries_[owner].range;
    for (const float time : note_largest(range, own)) add_peak(range, own, time);
  }
}

/// Returns the times at which weights are larger than ever before, the largest first.
std::vector<float> MorphRanges::note_largest(MorphRange& range, std::span<const AnimationCurve* const> curves) {
  std::vector<CurvePeak> peaks;
  for (const AnimationCurve* curve : curves) {
    const std::size_t end = curve->target + curve->width, before = range.largest.size();
    if (end > before && !spend(end - before)) break;
    range.largest.resize(std::max(end, before));
    for (std::size_t i = 0; i < curve->width; ++i) {
      float& largest = range.largest[curve->target + i];
      const CurvePeak peak = find_peak(*curve, i);
      if (peak.value > static_cast<double>(kLargerPeak * largest)) peaks.push_back(peak);
      largest = std::max(largest, static_cast<float>(peak.value));
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.value > b.value; });
  std::vector<float> times;
  for (const CurvePeak& peak : peaks)
    if (times.size() < kMostPeaks && std::find(times.begin(), times.end(), peak.time) == times.end())
      times.push_back(peak.time);
  return times;
}

/// What none of the curves moves stays as it is at rest.
void MorphRanges::add_peak(MorphRange& range, std::span<const AnimationCurve* const> curves, float time) {
  if (range.peaks.size() >= kMostPeaks || !spend(range.largest.size())) return;
  TargetWeights& weights = range.peaks.emplace_back(range.at_rest);
  weights.resize(std::max(weights.size(), range.largest.size()));
  for (const AnimationCurve* curve : curves)
    for (std::size_t i = 0; i < curve->width && curve->target + i < weights.size(); ++i)
      weights[curve->target + i] = static_cast<float>(value_at(*curve, time, i));
}

std::vector<const MorphRange*> MorphRanges::of(std::size_t node) const {
  std::vector<const MorphRange*> ranges;
  const auto own = entries_.find({false, node});
  if (own == entries_.end()) return ranges;
  if (own->second.mesh != kNoNode) ranges.push_back(&entries_.at({true, own->second.mesh}).range);
  ranges.push_back(&own->second.range);
  return ranges;
}

}  // namespace lodestone::detail

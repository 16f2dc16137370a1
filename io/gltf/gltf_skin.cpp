#include "gltf/gltf_skin.h"

#include <string>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone::detail {
namespace {

constexpr std::size_t kMatrixComponents = 16, kJointsPerSet = 4;

Result<std::vector<Transform>> read_inverse_binds(const GltfDocument& document, const Json& skin, std::size_t count,
                                                  const std::string& where) {
  std::vector<Transform> matrices(count);
  if (find_member(skin, "inverseBindMatrices") == nullptr) return matrices;
  LODESTONE_TRY(const std::size_t index, size_member(skin, "inverseBindMatrices", where));
  LODESTONE_TRY(const AccessorData data, document.accessor(index));
  if (data.component_count != kMatrixComponents || data.count < count)
    return fail(ErrorCode::Malformed, text(where, ": inverseBindMatrices are not ", count, " matrices"));
  const std::vector<float> values = to_floats(data);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        matrices[i].rows[row][column] = values[kMatrixComponents * i + 4 * column + row];
  return matrices;
}

void add_scaled(Transform& sum, const Transform& other, double factor) {
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) sum.rows[row][column] += factor * other.rows[row][column];
}

}  // namespace

std::vector<Transform> Skin::pose(std::span<const NodePlace> places) const {
  std::vector<Transform> matrices(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) matrices[i] = places[joints[i]].world * inverse_binds[i];
  return matrices;
}

Result<Skin> read_skin(const GltfDocument& document, std::size_t index) {
  const std::string where = text("skin ", index);
  const std::size_t node_count = document.count("nodes");
  LODESTONE_TRY(const Json* const json, document.element("skins", "skin", index));
  Skin skin;
  LODESTONE_TRY(skin.joints, size_array_member(*json, "joints", where));
  LODESTONE_TRY(skin.inverse_binds, read_inverse_binds(document, *json, skin.joints.size(), where));
  for (const std::size_t joint : skin.joints)
    if (joint >= node_count)
      return fail(ErrorCode::Malformed, text(where, ": node ", joint, " does not exist: the file has ", node_count));
  return skin;
}

Skinner::Skinner(std::span<const Attribute> attributes) {
  for (const Attribute& joints : attributes) {
    const bool unsigned_type = joints.type == ComponentType::UInt8 || joints.type == ComponentType::UInt16;
    if (!joints.name.starts_with("JOINTS_") || joints.component_count != kJointsPerSet || !unsigned_type) continue;
    const std::string partner = "WEIGHTS_" + joints.name.substr(7);
    for (const Attribute& weights : attributes)
      if (weights.name == partner && weights.component_count == kJointsPerSet)
        sets_.push_back({attribute_values(joints), attribute_values(weights)});
  }
}

Transform Skinner::pose(std::size_t point, std::span<const Transform> joints) const {
  Transform sum{};
  sum.rows = {};
  double total = 0;
  for (const Set& set : sets_)
    for (std::size_t k = kJointsPerSet * point; k < kJointsPerSet * (point + 1); ++k) {
      const auto joint = static_cast<std::size_t>(set.joints[k]);
      if (set.weights[k] == 0 || joint >= joints.size()) continue;
      add_scaled(sum, joints[joint], double{set.weights[k]});
      total += double{set.weights[k]};
    }
  if (!(total > 0)) {
    const auto first = static_cast<std::size_t>(sets_[0].joints[kJointsPerSet * point]);
    return first < joints.size() ? joints[first] : Transform{};
  }
  for (auto& row : sum.rows)
    for (double& value : row) value /= total;
  return sum;
}

}  // namespace lodestone::detail

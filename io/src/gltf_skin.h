#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "gltf_document.h"
#include "gltf_scene.h"
#include "transform.h"

namespace lodestone::detail {

/// Returns, for each joint of a skin, the map from the mesh's units to the world in the pose the nodes have: it undoes
/// quantisation, too, which writers put into the inverse bind matrices. Errors: Malformed.
Result<std::vector<Transform>> read_joints(const GltfDocument& document, std::span<const NodePlace> places,
                                           std::size_t skin);

/// Poses points by the joints and weights of all sets that there are.
class Skinner {
 public:
  explicit Skinner(std::span<const Attribute> attributes);

  bool empty() const { return sets_.empty(); }

  /// Returns where a point goes, as clients do: weights count by their share of the sum; without any, the first joint
  /// has the point. Joints that do not exist have no say. Pre: not `empty`.
  Transform pose(std::size_t point, std::span<const Transform> joints) const;

 private:
  struct Set {
    std::vector<float> joints, weights;
  };
  std::vector<Set> sets_;
};

}  // namespace lodestone::detail

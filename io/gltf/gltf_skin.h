#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "base/transform.h"
#include "gltf/gltf_document.h"
#include "gltf/gltf_scene.h"

namespace lodestone::detail {

/// The joints that move a mesh, read once, to pose them any number of times.
struct Skin {
  std::vector<std::size_t> joints;       ///< their nodes
  std::vector<Transform> inverse_binds;  ///< one for each; they undo quantisation, too, which writers put into them

  /// Returns, for each joint, the map from the mesh's units to the world where the nodes stand at `places`.
  std::vector<Transform> pose(std::span<const NodePlace> places) const;
};

/// Errors: Malformed, also where a joint's node does not exist.
Result<Skin> read_skin(const GltfDocument& document, std::size_t index);

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

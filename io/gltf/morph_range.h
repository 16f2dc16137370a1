#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "gltf/gltf_document.h"
#include "gltf/node_animation.h"

namespace lodestone::detail {

/// What morph targets are multiplied by, by target; 0 beyond the end.
using TargetWeights = std::vector<float>;

/// Returns the weights at which a node shows a mesh at rest: its own, else those of the mesh.
TargetWeights weights_at_rest(const GltfDocument& document, const Json& node, std::size_t mesh);

/// The weights that one node, or one mesh, is ever shown with.
struct MorphRange {
  TargetWeights at_rest;
  TargetWeights largest;             ///< without their signs, each for itself
  std::vector<TargetWeights> peaks;  ///< at times of animations when one of them is largest; a bounded number
};

/// What animations do to the weights of nodes that show meshes.
class MorphRanges {
 public:
  explicit MorphRanges(const GltfDocument& document) : document_(document) {}

  /// Notes the weights at rest of a node and its mesh, if it has any.
  void add_node(std::size_t index, const Json& node);
  /// Notes where an animation takes them. Curves of others, and of more targets than there are, are passed over.
  void add_animation(std::span<const AnimationCurve> curves);
  /// Returns what a node's mesh is shown with: the first has its weights at rest. Pre: the node was added.
  std::vector<const MorphRange*> of(std::size_t node) const;

 private:
  using Owner = std::pair<bool, std::size_t>;  // whether it is a mesh, and its number
  struct Entry {
    MorphRange range;
    std::size_t target_count = 0;
    std::size_t mesh = kNoNode;  // that shows for a node without weights of its own
  };

  static Owner owner_of(const AnimationCurve& curve);
  bool fits(const AnimationCurve& curve) const;
  bool spend(std::size_t numbers);
  std::vector<float> note_largest(MorphRange& range, std::span<const AnimationCurve* const> curves);
  void add_peak(MorphRange& range, std::span<const AnimationCurve* const> curves, float time);

  const GltfDocument& document_;
  std::map<Owner, Entry> entries_;
  std::size_t spent_ = 0;
};

}  // namespace lodestone::detail

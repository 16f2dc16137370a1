#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/core/result.h>

#include "base/transform.h"
#include "gltf/gltf_document.h"

namespace lodestone::detail {

inline constexpr std::size_t kNoSkin = static_cast<std::size_t>(-1);

/// A mesh of the document at a place in the world.
struct MeshInstance {
  std::size_t node = 0;  ///< the node that holds it, or kNoNode
  std::size_t mesh = 0;
  std::size_t skin = kNoSkin;  ///< that places its vertices in place of `world`
  Transform world;
};

inline constexpr std::size_t kNoNode = static_cast<std::size_t>(-1);

/// Returns how many levels of detail the nodes offer by MSFT_lod: 1 for an ordinary document.
Result<std::size_t> level_count(const GltfDocument& document);

/// Lists the meshes of the default scene (else of the first; else of all root nodes; else, without any node, all
/// meshes), in the order of a walk from the roots. A node with MSFT_lod is replaced by that of its level `level`, 0
/// being the finest, or by its last where it has fewer. A skinned mesh stands where its joints say: glTF ignores the
/// transform of its node. What EXT_mesh_gpu_instancing copies is there once for each copy.
/// Errors: Malformed for nodes that do not exist, have two parents or are their own ancestors.
Result<std::vector<MeshInstance>> collect_instances(const GltfDocument& document, std::size_t level);

/// A node's own transform: a matrix, or its parts, which animations can move.
struct LocalPlace {
  std::optional<Transform> matrix;
  Vec3 translation;
  std::array<double, 4> rotation{0, 0, 0, 1};
  Vec3 scale{1, 1, 1};

  Transform transform() const { return matrix ? *matrix : from_trs(translation, rotation, scale); }
};

/// Where a node stands.
struct NodePlace {
  Transform world;
  bool shown = false;  ///< it stands in a scene; in a document without scenes every node does
};

/// The nodes, read once, to place them in any number of poses.
class NodeTree {
 public:
  /// Errors: as above.
  static Result<NodeTree> read(const GltfDocument& document);
  /// By node, as the document has them.
  const std::vector<LocalPlace>& at_rest() const { return at_rest_; }
  /// Places every node, whatever scenes it stands in.
  std::vector<NodePlace> place(std::span<const LocalPlace> nodes) const;

 private:
  std::vector<LocalPlace> at_rest_;
  std::vector<std::size_t> parent_;  // by node, kNoNode for roots
  std::vector<std::size_t> order_;   // parents before their children
  std::vector<NodePlace> shown_;     // by node, without its place
};

/// Places every node as the document has it, whatever scenes it stands in. Errors: as above.
Result<std::vector<NodePlace>> place_nodes(const GltfDocument& document);

/// Returns the nodes of each MSFT_lod as [finest, …, coarsest], in the order of the finest ones.
Result<std::vector<std::vector<std::size_t>>> lod_chains(const GltfDocument& document);

}  // namespace lodestone::detail

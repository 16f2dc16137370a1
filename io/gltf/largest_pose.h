#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include <lodestone/core/result.h>

#include "base/transform.h"
#include "gltf/gltf_document.h"
#include "gltf/gltf_scene.h"
#include "gltf/morph_range.h"

namespace lodestone::detail {

/// What a skin's joints make of its meshes in one pose.
struct PosedSkin {
  std::vector<Transform> joints;
  double stretch = 0;  ///< the most that a length grows by any of them
};

/// Where a node shows its mesh: at its own place, or where its skin's joints have it.
struct ShownPlace {
  std::size_t skin = kNoSkin;
  Transform world;
};

/// Each node, and each skin, in the pose in which it draws meshes largest; and what morph targets reach.
struct LargestPoses {
  std::map<std::size_t, ShownPlace> nodes;
  std::map<std::size_t, PosedSkin> skins;
  MorphRanges morphs;
};

/// Finds these poses for some nodes that show meshes, and their skins: at rest, or at one of the key frames that
/// animations are looked at in, a bounded number of them. Of weights all key frames count.
/// Errors: Malformed, for nodes and skins; broken animations are passed over.
Result<LargestPoses> find_largest_poses(const GltfDocument& document, std::span<const std::size_t> nodes);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <vector>

#include "scene/scene_impl.h"

namespace lodestone::detail {

/// A node that shows one of the scene's meshes.
struct ScenePart {
  std::size_t mesh = 0;  ///< its number among the scene's
  std::size_t node = 0;  ///< its number among the nodes of that mesh's source
};

/// What is looked at as one thing, so that its parts change their level together.
struct SceneObject {
  std::vector<ScenePart> parts;
  Box box;  ///< of all parts in the world; of a node with many instances, of the largest
};

/// Groups the nodes that show meshes: what hangs from one root is one object, and so are roots whose boxes touch unless
/// one dwarfs the other, as the ground does a house. In the order of their first parts.
std::vector<SceneObject> find_objects(const Scene::Impl& scene);

}  // namespace lodestone::detail

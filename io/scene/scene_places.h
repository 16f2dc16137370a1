#pragma once

#include <lodestone/core/result.h>

#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Fills in what depends on where the meshes' nodes stand, each when animations have it largest: scale, area, number of
/// instances, the scene's box.
/// Pre: meshes, sources and their nodes are there. Errors: Malformed; LimitExceeded for scenes of too many corners.
Result<void> measure_instances(Scene::Impl& scene);

}  // namespace lodestone::detail

#pragma once

#include <lodestone/core/result.h>

#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Takes the levels of detail that `encode_scene` added out of a document again: what showed the finest level moves
/// back to the node it came from, the coarser ones go.
/// Errors: Unsupported where the levels do not stand as `encode_scene` puts them.
Result<void> take_out_levels(Scene::Impl& scene, std::size_t level);

}  // namespace lodestone::detail

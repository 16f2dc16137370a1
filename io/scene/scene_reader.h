#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/io/scene.h>

#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Reads a glTF as `Scene::read_bytes` does, with those of its images that do not lie in the bytes.
Result<Scene> read_with_images(std::span<const std::byte> bytes, std::vector<EmbeddedImage> images);

}  // namespace lodestone::detail

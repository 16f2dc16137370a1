#pragma once

#include <string>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>

#include "gltf/glb_builder.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Returns a path as a URI reference.
std::string uri_of(const std::filesystem::path& relative);

/// Makes every image of a scene a file beside the .gltf called `name`, and has the document refer to it. An image that
/// was such a file keeps its place; others are called after themselves, or after the .gltf.
/// Errors: Malformed where an image does not lie in its buffer.
Result<std::vector<AssetFile>> put_images_beside(const Scene::Impl& scene, const std::string& name,
                                                 GlbBuilder& builder);

}  // namespace lodestone::detail

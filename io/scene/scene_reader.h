#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <lodestone/io/scene.h>

#include "base/files_beside.h"
#include "gltf/gltf_document.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// A glTF that has been parsed, and what fetches the files beside it.
struct OpenedGltf {
  GltfDocument document;
  FileFetcher fetch;
  std::vector<std::filesystem::path> files;  ///< those fetched so far
};

/// Parses a glTF that requires nothing unknown. Errors: as those of GltfDocument, and Unsupported.
Result<OpenedGltf> open_gltf(std::span<const std::byte> bytes, FileFetcher fetch);

/// Makes a scene of a glTF without levels, given those of its images that do not lie in it. Errors: as `Scene::read`.
Result<Scene> scene_of(OpenedGltf gltf, std::vector<EmbeddedImage> images);

/// Makes a scene of a glTF with one of its levels. Errors: as `Asset::scene`.
Result<Scene> scene_of_level(OpenedGltf gltf, std::size_t level);

}  // namespace lodestone::detail

#pragma once

#include <vector>

#include "base/files_beside.h"
#include "mesh/soup_file.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Adds the images that lie in files of their own or in data URIs, to be embedded; those that `images` has already
/// stay. One that cannot be had keeps its uri, and a note says so.
void fetch_images(const GltfDocument& document, const FileFetcher& fetch, std::vector<EmbeddedImage>& images,
                  std::vector<std::string>& notes);

}  // namespace lodestone::detail

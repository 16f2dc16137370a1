#pragma once

#include <vector>

#include "base/files_beside.h"
#include "mesh/soup_file.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// Gets the images that lie in files of their own or in data URIs, to be embedded. One that cannot be had keeps its
/// uri, and a note says so.
std::vector<EmbeddedImage> fetch_images(const GltfDocument& document, const FileFetcher& fetch,
                                        std::vector<std::string>& notes);

}  // namespace lodestone::detail

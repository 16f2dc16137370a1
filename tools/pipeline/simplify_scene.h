#pragma once

#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_asset.h>

namespace lodestone::detail {

/// Simplifies each mesh of a scene as far as the targets may want it, or to its base where a stream is written.
Result<std::vector<SimplifyResult>> simplify_scene(const Scene& scene, const BuildOptions& options,
                                                   BuildObserver& observer);

/// Whether each mesh's removal stream is written.
bool writes_streams(const BuildOptions& options);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/progress.h>
#include <lodestone/core/result.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_options.h>

#include "pipeline/measured_scene.h"
#include "pipeline/scene_fitter.h"

namespace lodestone::detail {

/// Places levels of compact streams closer to the meshes.
struct StreamPlacer {
  MeasuredScene& measured;
  SceneFitter& fitter;
};

/// The stream of each mesh, or why it has none.
using MeshStreams = std::vector<Result<std::vector<std::byte>>>;

/// How each mesh's compact stream is encoded.
std::vector<CompactOptions> stream_options(const Scene& scene, const BuildOptions& build);

/// Encodes the streams. `placer`: null where the vertices of levels stay where they are: beside levels of its own in
/// the file a stream is not what is drawn from. What a compact stream does not hold, one of version 2 may, if the
/// layout has such. Errors: Cancelled.
Result<MeshStreams> encode_streams(const Scene& scene, const std::vector<SimplifyResult>& simplified,
                                   const BuildOptions& build, const StreamPlacer* placer, const Progress& progress);

}  // namespace lodestone::detail

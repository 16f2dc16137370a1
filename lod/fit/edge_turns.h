#pragma once

#include <cstdint>
#include <span>

#include <lodestone/core/mesh.h>

#include "fit/constrained_edges.h"
#include "fit/face_guard.h"
#include "fit/fit_samples.h"

namespace lodestone::detail {

/// Turns edges inside quadrilaterals where that brings the samples of the two faces nearer; each face takes part at
/// most once, and none whose corners are all `fixed` (by vertex). Textures do not turn over, faces neither, the guard
/// lets the new ones pass, and no edge appears twice. Samples go over to the nearer of their quad's new faces. Edges
/// that `stays` says so of are not tried; it is set where turning would have made things far worse, and none of the two
/// faces has got another edge since. Returns how many edges were turned: `edges` is out of date then but for that.
std::size_t turn_edges(Mesh& mesh, std::span<MeshEdge> edges, std::span<SurfaceSample> samples, SampleNorm norm,
                       const OriginalGuard& guard, std::span<const std::uint8_t> fixed);

}  // namespace lodestone::detail

#pragma once

#include <span>

#include <lodestone/core/mesh.h>

#include "constrained_edges.h"
#include "fit_samples.h"

namespace lodestone::detail {

/// Turns edges inside quadrilaterals where that brings the samples of the two faces nearer; each face takes part at most
/// once. Textures do not turn over, faces neither, and no edge appears twice. Returns how many were turned: `edges` and
/// the samples' faces are out of date then.
std::size_t turn_edges(Mesh& mesh, std::span<const MeshEdge> edges, std::span<const SurfaceSample> samples);

}  // namespace lodestone::detail

#pragma once

#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/curvature.h>
#include <lodestone/core/removal.h>
#include <lodestone/lod/simplify_options.h>

#include "simplify/carried_points.h"
#include "simplify/feature_lines.h"

namespace lodestone::detail {

/// What costs are computed from; shared by all evaluations of a run.
struct SimplifyState {
  const Mesh& mesh;
  Connectivity connectivity;
  CarriedPoints points;
  FeatureLines lines;
  std::vector<VertexCurvature> curvature;  ///< of the current mesh
  std::vector<float> original_curvature;   ///< of the full mesh, in the metric's own unit
};

/// Returns the curvature that a metric looks at, in its own unit; the hybrid metric looks at K̄.
double metric_curvature(const SimplifyOptions& options, const VertexCurvature& curvature);

/// Moves the memory of the removed surface along with a removal that has just been done: the points of the star's
/// faces, and the removed vertex, to the nearest of the new faces.
void carry_points(SimplifyState& state, const RemovalRecord& record);

/// The same for the lines through the vertex: to the edges in their place.
void carry_lines(SimplifyState& state, const RemovalRecord& record);

}  // namespace lodestone::detail

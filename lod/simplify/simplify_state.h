#pragma once

#include <span>
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
  std::vector<double> gaussian;            ///< K̄ of the current mesh where costs need no more; else empty
  std::vector<VertexCurvature> curvature;  ///< of the current mesh, else
  std::vector<float> original_curvature;   ///< of the full mesh, in the metric's own unit

  VertexCurvature curvature_at(Index vertex) const {
    return gaussian.empty() ? curvature[vertex] : VertexCurvature{gaussian[vertex], 0, 0};
  }
};

/// Whether the metric needs no curvature but K̄, not divided by areas.
inline bool tracks_gaussian_curvature(const SimplifyOptions& options) {
  return options.metric == Metric::Hybrid && options.normalisation == Normalisation::Integral;
}

/// Fills `gaussian` or `curvature`, and `original_curvature`.
void gather_curvature(SimplifyState& state, const SimplifyOptions& options);

/// Works out the curvature of a vertex anew.
void update_curvature(SimplifyState& state, const SimplifyOptions& options, Index vertex);

/// Takes over K̄ of the vertices around a removal, where it is known; else `gaussian` is empty.
void keep_curvature(SimplifyState& state, std::span<const RemovalRecord> records, std::span<const double> gaussian);

/// Returns the curvature that a metric looks at, in its own unit; the hybrid metric looks at K̄.
double metric_curvature(const SimplifyOptions& options, const VertexCurvature& curvature);

/// Moves the lines through a vertex along with its removal, which has just been done: to the edges in their place.
void carry_lines(SimplifyState& state, const RemovalRecord& record);

}  // namespace lodestone::detail

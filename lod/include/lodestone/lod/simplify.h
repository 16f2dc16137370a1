#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// What a removal is charged for.
enum class Metric {
  Hybrid,     ///< swept volume, distance of everything removed so far, and mean curvature: the default
  Gaussian,   ///< change of the Gaussian curvature K̄ at the ring (radians as an integral)
  Mean,       ///< change of the absolute mean curvature H̄ at the ring (a length as an integral)
  Principal,  ///< change of the sum of absolute principal curvatures at the ring (a length as an integral)
};

/// Whether a curvature is taken over a vertex's area share, or divided by it.
enum class Normalisation { Integral, Density };

/// The surface whose curvature a removal is compared with.
enum class Reference {
  Original,  ///< the full mesh: a global error
  Current,   ///< the mesh just before the removal: a local error
};

/// When to stop; unset limits do not stop. The first limit met ends the run.
struct StopCriteria {
  std::size_t min_faces = 0;                                              ///< go no lower than this face count allows
  double max_curvature_error = std::numeric_limits<double>::infinity();   ///< the metric's own unit
  double max_deviation = std::numeric_limits<double>::infinity();         ///< mesh units, of the two-sided bound
};

struct SimplifyOptions {
  Metric metric = Metric::Hybrid;
  Normalisation normalisation = Normalisation::Integral;
  Reference reference = Reference::Original;
  StopCriteria stop;
  /// Measure the deviation each time this share of the faces has gone. In between, and everywhere where it is 0, bounds
  /// add up what each removal may have moved: safe, but wider than the truth.
  double measure_step = 0.1;
  /// Called between rounds with the share of the work done, 0 to 1; return false to cancel.
  std::function<bool(double)> progress;
};

/// Why no more vertices were removed.
enum class StopReason { Faces, CurvatureError, Deviation, Stuck, Cancelled };

/// What kept the remaining vertices, where the run ended for want of legal removals.
struct BlockedCounts {
  std::size_t locked = 0;    ///< corner, non-manifold copy or other kind this version does not remove
  std::size_t flip = 0;      ///< every retriangulation turns a triangle over or makes it degenerate
  std::size_t link = 0;      ///< every retriangulation repeats an edge of the mesh
  std::size_t ring = 0;      ///< more neighbours than a record holds
};

struct SimplifyResult {
  ProgressiveMesh mesh;
  StopReason stop_reason = StopReason::Stuck;
  BlockedCounts blocked;          ///< of the base mesh's vertices
  std::size_t evaluation_count = 0;
};

/// Simplifies a mesh to its base by removing vertices in rounds, cheapest first, and records every removal.
///
/// Pre: `mesh` comes from `assemble` (every vertex has one fan of faces). The result's full level is `mesh` with
/// vertices, wedges and faces renumbered. Deterministic. Errors: InvalidArgument where the mesh is not manifold.
Result<SimplifyResult> simplify(const Mesh& mesh, const SimplifyOptions& options = {});

}  // namespace lodestone

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/lod/progressive_mesh.h>
#include <lodestone/lod/simplify_options.h>

namespace lodestone {

/// Why no more vertices were removed.
enum class StopReason { Faces, CurvatureError, Deviation, Stuck, Cancelled };

/// What kept the remaining vertices, where the run ended for want of legal removals.
struct BlockedCounts {
  std::size_t locked = 0;   ///< by the options: border or importance
  std::size_t flip = 0;     ///< every retriangulation turns a triangle over, or too far
  std::size_t link = 0;     ///< every retriangulation repeats an edge of the mesh
  std::size_t shape = 0;    ///< every retriangulation leaves a sliver worse than those that were there
  std::size_t ring = 0;     ///< more neighbours than a record holds
  std::size_t texture = 0;  ///< every retriangulation turns a texture over
  std::size_t error = 0;    ///< free to go, but beyond a limit on the error
};

/// Adds up what kept the vertices of several meshes.
BlockedCounts operator+(const BlockedCounts& a, const BlockedCounts& b);

/// A progressive mesh, and why it goes no further.
struct SimplifyResult {
  ProgressiveMesh mesh;
  StopReason stop_reason = StopReason::Stuck;
  BlockedCounts blocked;  ///< of the base mesh's vertices
  /// By position, as `mesh.deviation`: the most that any removal between the full mesh and the position was charged. It
  /// never falls towards the base, so that meshes simplified alike can share faces by it. Mesh units, but radians for
  /// Metric::Gaussian.
  std::vector<float> charge;
  std::vector<std::uint8_t> locked;  ///< by vertex of the mesh given: 1 where the options kept it; empty where nowhere
  std::size_t evaluation_count = 0;
};

/// Simplifies a mesh to its base by removing vertices in rounds, cheapest first, and records every removal.
///
/// Pre: `mesh` comes from `assemble` (every vertex has one fan of faces). The result's full level is `mesh` with
/// vertices, wedges and faces renumbered. Deterministic. Errors: InvalidArgument where the mesh is not manifold,
/// LimitExceeded beyond 715 million faces, whose records 32-bit indices might not number.
Result<SimplifyResult> simplify(const Mesh& mesh, const SimplifyOptions& options = {});

}  // namespace lodestone

#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <lodestone/core/effort.h>
#include <lodestone/core/progress.h>

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
  std::size_t min_faces = 0;                                             ///< go no lower than this face count allows
  double max_curvature_error = std::numeric_limits<double>::infinity();  ///< the metric's own unit
  double max_deviation = std::numeric_limits<double>::infinity();        ///< mesh units, of the two-sided bound
};

/// How much differences of attributes count beside distances: factors, 0 for not at all. What is compared is the
/// attribute of a removed vertex with that of the surface in its place. A vertex's own attributes never change.
struct AttributeWeights {
  double normal = 0.25;  ///< NORMAL: difference of unit vectors, times the star's radius
  double texcoord = 1;   ///< TEXCOORD_n: how far the texture slides over the surface
  double color = 0.5;    ///< COLOR_n: difference of values, times the star's radius
  double skin = 3;       ///< JOINTS_n, WEIGHTS_n: share of weight that goes to other joints, times the star's radius
  double target = 3;     ///< morph targets ("TARGET_i:POSITION"): difference of displacements
  /// By number i of the morph target: the largest weight that it is shown at, which multiplies `target`; 1 for others.
  std::vector<double> target_reach;
};

/// A vertex of at least this importance stays.
inline constexpr float kLockingImportance = 1000;

/// What a removal is charged for, what is kept, and where to stop.
struct SimplifyOptions {
  Metric metric = Metric::Hybrid;
  Normalisation normalisation = Normalisation::Integral;
  Reference reference = Reference::Original;
  AttributeWeights weights;
  /// Hard edges by angle: where two faces' normals differ by more than this, in radians, the edge between them is kept
  /// as a line. Unset: only edges whose attributes or materials differ.
  std::optional<double> crease_angle;
  bool lock_border = false;  ///< keep every vertex of an edge that has one face only
  /// Let the last piece of the mesh go, too, so that the base mesh is empty. Smaller pieces always may.
  bool vanish = false;
  std::vector<float> importance;  ///< one per vertex of the mesh, or empty: multiplies the vertex's cost; 0 or more
  /// Above 0: removals come in few rounds, whose records code into the fewest bytes (`encode_compact`). A round then
  /// takes as many vertices as it can, no two of them neighbours and the dearer seldom, of all that cost at most this
  /// many times the median. By 1.2 streams are a fifth smaller than by 0, and levels of as many faces lie a twentieth
  /// further off; by 1.5 one part in a hundred smaller, and a tenth further off. 0: a round takes the cheapest.
  double dense_rounds = 0;
  StopCriteria stop;
  /// See core/effort.h. By the hybrid metric up to 2 the volume swept is charged alone; from 3 on the distances of what
  /// was removed are, too, of one way to fill a hole at first, of more from 5 and from 8 on. The others know no effort.
  int effort = kDefaultEffort;
  /// Measure the deviation each time this share of the faces has gone. In between, and everywhere where it is 0, bounds
  /// add up what each removal may have moved: safe, but wider than the truth.
  double measure_step = 0.1;
  /// Cancelled, the run ends with what was removed so far: a mesh as good as any, its bounds perhaps wide.
  Progress progress;
};

}  // namespace lodestone

#pragma once

#include <array>
#include <cstdint>

#include <lodestone/lod/simplify_options.h>

#include "simplify/removal_rules.h"

namespace lodestone::detail {

/// Which triangulation each sector of a star was given, or which spoke a corner was moved along, for evaluating it
/// again.
using Choice = std::array<std::uint8_t, 2>;
inline constexpr std::uint8_t kNoChoice = 255;
inline constexpr std::uint8_t kAlongSpoke = 254;  // in place of the second: copies moved along the spoke named first
inline constexpr std::uint8_t kPlain = 253;       // the same: a filling by the plain stars' own numbers

struct Evaluation {
  Verdict verdict = Verdict::Locked;
  double cost = 0;             ///< orders removals; for the pure curvature metrics it is the curvature error
  double curvature_error = 0;  ///< ε, in the metric's own unit
};

/// What a removal moves, as the hybrid metric charges it.
struct Displacement {
  double squared_volume = 0;      ///< V²: swept between old and new faces, summed over the tetrahedra
  double squared_distance = 0;    ///< D²: see charged_distance; where distances are measured
  double squared_attributes = 0;  ///< squared lengths that stand for differences of attributes
  double line = 0;                ///< what borders and feature lines are charged, a length
};

/// Returns the squared distance that a removal is charged for: what the carried points have after it, less most of what
/// they had before.
double charged_distance(double after, double before);

/// Returns D² of the points and the new surface: the squared distances that the carried points are charged for, and
/// those of the new faces to the old ones.
inline double joined_distance(double charged, double bridge) {
  constexpr double kBridgeWeight = 3;  // of new surface where the star had none, against distances of points
  return charged + kBridgeWeight * bridge;
}

/// The cost of a removal by the hybrid metric: `moved` is what it moves, a length, `turned` the change of curvature in
/// radians, which only orders removals that move alike.
inline constexpr double kDistanceExponent = 0.95;
double hybrid_cost(double moved, double turned);
double hybrid_cost(const Displacement& moved, bool measures_distances, double turned);

/// How many triangulations of a hole, by swept volume, have their distances measured; 0: none, volume alone counts.
inline constexpr std::size_t kMostMeasured = 8;
std::size_t measured_triangulations(const SimplifyOptions& options);

}  // namespace lodestone::detail

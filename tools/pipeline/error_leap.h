#pragma once

#include <span>

#include <lodestone/lod/progressive_mesh.h>

namespace lodestone::detail {

/// What a level's error is compared with, in mesh units.
struct LeapScale {
  double mesh = 0;   ///< the mesh's own diagonal
  double scene = 0;  ///< that of all that is drawn
};

/// Returns the coarsest whole position of a part before its error leaps: before it exceeds eight times what it was with
/// twice as many faces. That is taken as 2 % of the mesh's diagonal at least, since the first faces of a clean shape
/// always cost infinitely more than none; and an error below 1 % of the scene's is none to stop for.
/// Shapes: `face_counts` and `errors` (mesh units, falling) by position.
Index position_before_leap(const ProgressiveMesh& mesh, std::span<const Index> face_counts,
                           std::span<const double> errors, const LeapScale& scale);

/// Whether an error at a position leaps, as above. Pre: 0 ≤ position < errors.size() − 1.
bool is_leap(double error, Index position, std::span<const Index> face_counts, std::span<const double> errors,
             const LeapScale& scale);

/// Whether an error is so many times what a part would have by itself that it must come from the burden of others.
bool is_burdened(double error, double error_alone, const LeapScale& scale);

}  // namespace lodestone::detail

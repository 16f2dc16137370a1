#pragma once

#include <span>

#include "distance/triangle.h"

namespace lodestone::detail {

/// Covers rounding: far above that of a distance, far below any tolerance.
inline constexpr double kRoundingSlack = 1 + 1e-12;

/// Returns an upper bound of the two-sided distance between two small sets of triangles, each compared with each: at
/// most a tenth above it, but for rounding and shapes that need too many parts. Neither set is empty.
double patch_distance_bound(std::span<const Triangle> a, std::span<const Triangle> b);

}  // namespace lodestone::detail

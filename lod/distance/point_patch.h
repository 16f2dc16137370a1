#pragma once

#include <span>

#include <lodestone/core/triangulation.h>
#include <lodestone/core/vec.h>

#include "distance/point_triangle.h"

namespace lodestone::detail {

/// Triangles over common corners, whose inner edges two of them share: a triangulated polygon, or all faces around a
/// corner 0. Relative to the origin of the points it is compared with.
///
/// Of an inner edge one of the two triangles has it from its first corner to its second or from there to its third.
struct Patch {
  std::span<const Vec3> corners;
  std::span<const PolygonTriangle> triangles;
};

/// Writes the squared distance of each point to the nearest of a patch's triangles; `out` has points.padded_size()
/// entries. Single precision: the points' origin should lie near. Edges that two triangles share are looked at once.
void squared_distances(const PointBatch& points, const Patch& patch, float* out);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// What polygons become. Corners are numbered through all polygons, in the order in which they were given.
struct SplitPolygons {
  std::vector<Index> corners;     ///< three a triangle
  std::vector<Index> polygon;     ///< one a triangle: the polygon it is a part of
  std::size_t short_count = 0;    ///< polygons of fewer than three corners; nothing comes of them
  std::size_t crossed_count = 0;  ///< fans that overlap or reach outside: the outline crosses itself or is too long
};

/// Splits polygons into triangles that cover them and nothing else, all of their corners kept.
///
/// Convex ones become a fan around their first corner. The rest is triangulated by GEOS in the plane that the polygon
/// is nearest to. Shapes: `corners` has the position of each corner, `sizes` an entry for each polygon. Cost: linear in
/// the corners, for outlines that are not convex up to cubic, within a budget for all together.
SplitPolygons split_polygons(std::span<const Vec3f> positions, std::span<const Index> corners,
                             std::span<const Index> sizes);

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <lodestone/core/triangulation.h>
#include <lodestone/core/vec.h>

#include "distance/point_triangle.h"

namespace lodestone::detail {

/// What distances to some triangles take, in single precision, relative to the points' origin: an array over the
/// triangles for each number, so that setting up vectorises, too.
///
/// Of a triangle two edges count: from its first corner to its second, and from there to its third. In a triangulated
/// polygon, and around a corner 0, the third is another triangle's; but for the polygon's last edge.
class FaceFrames {
 public:
  static constexpr std::size_t kMost = 16;

  /// Pre: 1 ≤ triangles.size() ≤ kMost.
  void set(std::span<const Vec3> corners, std::span<const PolygonTriangle> triangles);

  /// Writes the squared distances of all points to the first triangle, then those to the next, and so on: `out` has
  /// points.padded_size() entries for each.
  void squared_distances(const PointBatch& points, float* out) const;
  /// Writes the squared distance of each point to the nearest of the triangles; `out` has points.padded_size() entries.
  void least_squared_distances(const PointBatch& points, float* out) const;

 private:
  using Numbers = std::array<float, kMost>;
  struct Vectors {
    Numbers x{}, y{}, z{};
  };
  struct Frame;
  Frame frame(std::size_t triangle) const;

  std::size_t count_ = 0;
  Vectors start_;                                                  // the first corner, which all else is relative to
  Vectors normal_;                                                 // of any length
  Vectors first_, second_;                                         // edges
  Vectors inside_first_, inside_second_, inside_third_;            // across each edge
  Numbers inverse_normal_{}, inverse_first_{}, inverse_second_{};  // of squared lengths
  Numbers second_level_{};                                         // of the second edge, along what leads across it
};

/// Writes the squared distance of each point to a segment; `out` has points.padded_size() entries.
void squared_distances(const PointBatch& points, const Vec3& from, const Vec3& to, float* out);

}  // namespace lodestone::detail

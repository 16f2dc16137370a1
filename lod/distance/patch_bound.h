#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns for each corner, standing for the edge from it to the next one, the corner that stands for the same edge in
/// the face across it; kNoIndex at a border and where not exactly two half-edges meet.
std::vector<Index> opposite_corners(const Mesh& mesh);

/// Bounds the distance from a triangle to a surface by showing that the surface spans it.
///
/// Take the faces that lie over or under the triangle, seen along its normal, and hang together. If the outline of that
/// patch, projected into the triangle's plane, winds around the triangle without entering it, then every point of the
/// triangle has a point of the patch right above or below it (the degree of the projection is not 0), and the greatest
/// height of the patch over the triangle bounds the distance.
class PatchBound {
 public:
  /// Pre: both outlive the object; `opposite` are the surface's opposite_corners.
  PatchBound(const Mesh& surface, std::span<const Index> opposite);

  /// Returns an upper bound of the distances from `triangle` to the surface, or infinity where this shows none that is
  /// at most `target`. The patch is looked for around the face `start`; gaps as narrow as `slack` are bridged.
  double bound(const std::array<Vec3, 3>& triangle, Index start, double target, double slack);

  /// The faces of the last patch, complete where the bound was finite.
  std::span<const Index> patch() const { return patch_; }

 private:
  /// A point in a triangle's frame: x and y in its plane, its height over it, and the triangle's edges seen from there:
  /// twice the area with each, positive inside.
  struct Point {
    double x, y, height;
    std::array<double, 3> side;
  };
  using Points = std::array<Point, 3>;

  /// The triangle in its own plane, a little smaller than it is.
  struct Frame {
    struct Corner {
      double x, y;
    };
    Vec3 origin, x_axis, y_axis, normal;
    std::array<Corner, 3> corners;

    Point project(const Vec3& p) const;
  };

  static bool make_frame(const std::array<Vec3, 3>& triangle, double slack, Frame& frame);
  static bool separated(const Frame& frame, const Points& other);
  static double clipped_height(const Points& subject);
  static int crossing(const Point& p, const Point& q, const Point& centre);

  Points project(const Frame& frame, Index face) const;
  bool add_if_over(const Frame& frame, Index face);
  bool add_across(const Frame& frame, Index other, const Point& at_other, const Point& after_other);
  bool add_tested(const Frame& frame, Index face, const Points& points);
  bool was_tested(Index face) const { return state_[face] / 2 == run_; }
  void start_patch(const Frame& frame, Index start);
  bool start_in_star(const Frame& frame, Index corner);
  bool visit_outline(const Frame& frame, Index face, const Points& points, const Point& centre, int& winding);

  const Mesh& surface_;
  std::span<const Index> opposite_;
  std::vector<Index> patch_;
  std::vector<Points> points_;        // Of the patch's faces.
  std::vector<std::uint32_t> state_;  // Per face: 2·run_ if tested in this run, + 1 if in the patch.
  std::uint32_t run_ = 0;
};

}  // namespace lodestone::detail

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

/// Calls `visit(face)` for the other faces around a corner's vertex, as far as the next border one way round, until one
/// is true; returns whether one was.
template <class Visit>
bool any_face_around(std::span<const Index> opposite, Index corner, const Visit& visit) {
  for (Index c = opposite[corner]; c != kNoIndex; c = opposite[c]) {
    c = next_corner(c);
    if (c == corner) return false;
    if (visit(face_of_corner(c))) return true;
  }
  return false;
}

/// Bounds the distance from a triangle to a surface by showing that the surface spans it.
///
/// Take faces that lie over or under the triangle, seen along its normal, and hang together. If the outline of that
/// patch, projected into the triangle's plane, winds around the triangle without entering it, then every point of the
/// triangle has a point of the patch right above or below it (the degree of the projection is not 0), and the greatest
/// height of the patch over the triangle bounds the distance. Which faces do not matter: the patch grows across those
/// edges alone that enter the triangle, so that walls beyond an edge beside it are left out.
class PatchBound {
 public:
  /// Pre: both outlive the object; `opposite` are the surface's opposite_corners. `close_from`: bounds are as close as
  /// they can be from this share of their target on, and need only be below it where they are less; closer takes
  /// longer.
  PatchBound(const Mesh& surface, std::span<const Index> opposite, double close_from = 1);

  /// Returns an upper bound of the distances from `triangle` to the surface, or infinity where this shows none that is
  /// at most `target`. The patch is looked for around the face `start`; gaps as narrow as `slack` are bridged.
  double bound(const std::array<Vec3, 3>& triangle, Index start, double target, double slack);

  /// The faces of the last patch, complete where the bound was finite.
  std::span<const Index> patch() const { return patch_; }

 private:
  /// A point, seen by a triangle: from each of its edges, twice the area that the two span in the triangle's plane,
  /// positive inside; and how high it lies over that plane. The first three are its barycentric coordinates there, but
  /// for the triangle's area. Bit i: not inside of edge i.
  struct Point {
    std::array<double, 4> seen;
    unsigned outside;

    double height() const { return seen[3]; }
  };
  using Points = std::array<Point, 3>;

  /// A face of the patch.
  struct Taken {
    Points points;
    Index entered = kNoIndex;  // By which of its edges it was come to; its first faces by none.
  };

  /// What sees them: the triangle in its own plane, a little smaller than it is.
  struct Frame {
    Vec3 centre;
    std::array<double, 4> x_factors, y_factors, z_factors, constants;

    Point project(const Vec3& p) const;
  };

  static bool make_frame(const std::array<Vec3, 3>& triangle, double slack, Frame& frame);
  static bool is_apart(const Point& p, const Point& q);
  static bool is_apart(const Points& face);
  static double clipped_height(const Points& subject);
  static int crossing(const Point& p, const Point& q);

  Points project(const Frame& frame, Index face) const;
  void start_patch(const Frame& frame, Index start);
  bool start_around(const Frame& frame, Index corner, const Points& start);
  bool start_with(Index face, const Points& points);
  bool grow(const Frame& frame, Index face, const Taken& taken, int& winding);
  bool take_across(const Frame& frame, Index face, const Points& points, Index edge);
  bool take(Index face);

  const Mesh& surface_;
  std::span<const Index> opposite_;
  double close_from_;
  std::vector<Index> patch_;
  std::vector<Taken> last_, before_;     // Of the patch's faces: those taken last, and those it grows across.
  std::vector<std::uint16_t> taken_in_;  // By face: the last run that it was in the patch of, since these began anew.
  std::uint16_t run_ = 0;
  double limit_ = 0;   // That heights may have in this run.
  double height_ = 0;  // Of the patch.
};

}  // namespace lodestone::detail

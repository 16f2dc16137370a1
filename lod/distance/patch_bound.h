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
/// height of the patch over the triangle bounds the distance. Which faces do not matter: those that are too high, walls
/// beyond an edge, are left out.
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
  /// A point in a triangle's frame: x and y in its plane, in a unit of their own, its height over it, and the
  /// triangle's edges seen from there: twice the area with each in that unit, positive inside. Bit i: not inside of
  /// edge i.
  struct Point {
    double x, y, height;
    std::array<double, 3> side;
    unsigned outside;
  };
  using Points = std::array<Point, 3>;

  /// The triangle in its own plane, a little smaller than it is.
  struct Frame {
    struct Corner {
      double x, y;
    };
    /// What grows with the distance from an edge: x_factor·x + y_factor·y + constant.
    struct Edge {
      double x_factor, y_factor, constant;
    };
    Vec3 origin, x_axis, y_axis, normal;
    std::array<Corner, 3> corners;
    std::array<Edge, 3> edges;

    Point project(const Vec3& p) const;
  };

  static bool make_frame(const std::array<Vec3, 3>& triangle, double slack, Frame& frame);
  static bool separated(const Frame& frame, const Points& other);
  static bool edge_separates(const Frame& frame, const Points& other);
  static double clipped_height(const Points& subject);
  static int crossing(const Point& p, const Point& q);

  /// What a face is to the triangle: not over or under it, part of the patch, or too high over it for that.
  enum class Standing : std::uint32_t { Apart, InPatch, TooHigh };
  static constexpr std::uint32_t kStandings = 3;

  Points project(const Frame& frame, Index face) const;
  Standing add_if_over(const Frame& frame, Index face);
  Standing add_across(const Frame& frame, Index other, const Point& at_other, const Point& after_other);
  Standing add_tested(const Frame& frame, Index face, const Points& points);
  Standing judge(const Frame& frame, const Points& points);
  bool was_tested(Index face) const { return state_[face] / kStandings == run_; }
  Standing standing(Index face) const { return static_cast<Standing>(state_[face] % kStandings); }
  void start_patch(const Frame& frame, Index start);
  bool visit_outline(const Frame& frame, Index face, const Points& points, int& winding);

  const Mesh& surface_;
  std::span<const Index> opposite_;
  std::vector<Index> patch_;
  std::vector<Points> points_;        // Of the patch's faces.
  std::vector<std::uint32_t> state_;  // Per face: kStandings·run_ + its standing if tested in this run.
  std::uint32_t run_ = 0;
  double limit_ = 0;   // That heights may have in this run.
  double height_ = 0;  // Of the patch.
};

}  // namespace lodestone::detail

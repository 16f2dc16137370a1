// The degree of a map as a proof of coverage: see for instance J. Milnor, "Topology from the Differentiable Viewpoint",
// 1965, section 5. The degree of the patch's projection is constant where its outline does not go, and it is the
// winding number of the outline there.

#include "distance/patch_bound.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace lodestone::detail {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// For the line from p to q in the plane, by barycentric coordinates: how each of the triangle's corners lies to it,
/// above 0 to its left.
std::array<double, 3> corners_beside(const std::array<double, 4>& p, const std::array<double, 4>& q) {
  return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

/// On which side all corners are: 1 left, −1 right; 0 where some are on each, or all on the line.
int common_side(const std::array<double, 3>& beside) {
  const bool left = beside[0] >= 0 && beside[1] >= 0 && beside[2] >= 0;
  const bool right = beside[0] <= 0 && beside[1] <= 0 && beside[2] <= 0;
  return static_cast<int>(left) - static_cast<int>(right);
}

/// A half-edge at the lower of its ends: the other end in the upper half, and the corner that it leaves.
using EdgeEnd = std::uint64_t;

constexpr Index corner_of(EdgeEnd half) { return static_cast<Index>(half); }

/// Notes which of the half-edges at a vertex stand for the same edge: just two, one each way. So the relation is
/// symmetric: the outline of a patch is counted from both of its sides.
void match(const Mesh& mesh, Index vertex, std::vector<EdgeEnd>& halves, std::vector<Index>& opposite) {
  std::sort(halves.begin(), halves.end());
  const auto leaves = [&](EdgeEnd half) { return mesh.corner_vertex(corner_of(half)) == vertex; };
  for (std::size_t i = 0, j = 0; i < halves.size(); i = j) {
    while (j < halves.size() && halves[j] >> 32 == halves[i] >> 32) ++j;
    const bool are_two = j - i == 2 && leaves(halves[i]) != leaves(halves[i + 1]);
    for (std::size_t k = i; k < j; ++k)
      opposite[corner_of(halves[k])] = are_two ? corner_of(halves[i + j - 1 - k]) : kNoIndex;
  }
}

}  // namespace

std::vector<Index> opposite_corners(const Mesh& mesh) {
  // Until a vertex's turn comes, the result links the half-edges of which it is the lower end.
  std::vector<Index> opposite(mesh.corner_wedge.size()), first(mesh.vertex_count(), kNoIndex);
  const auto end = [&](Index corner) { return mesh.corner_vertex(next_corner(corner)); };
  for (Index c = 0; c < opposite.size(); ++c)
    opposite[c] = std::exchange(first[std::min(mesh.corner_vertex(c), end(c))], c);
  std::vector<EdgeEnd> halves;
  for (Index v = 0; v < first.size(); ++v) {
    halves.clear();
    for (Index c = first[v]; c != kNoIndex; c = opposite[c])
      halves.push_back(EdgeEnd{std::max(mesh.corner_vertex(c), end(c))} << 32 | c);
    match(mesh, v, halves, opposite);
  }
  return opposite;
}

PatchBound::PatchBound(const Mesh& surface, std::span<const Index> opposite, double close_from)
    : surface_(surface), opposite_(opposite), close_from_(close_from), taken_in_(surface.face_count(), 0) {}

PatchBound::Point PatchBound::Frame::project(const Vec3& p) const {
  const Vec3 d = p - centre;
  Point point;
  for (std::size_t i = 0; i < 4; ++i)
    point.seen[i] = d.x * x_factors[i] + d.y * y_factors[i] + d.z * z_factors[i] + constants[i];
  point.outside = static_cast<unsigned>(point.seen[0] <= 0) | static_cast<unsigned>(point.seen[1] <= 0) << 1 |
                  static_cast<unsigned>(point.seen[2] <= 0) << 2;
  return point;
}

/// Sets up the plane of a triangle; false where it has none.
bool PatchBound::make_frame(const std::array<Vec3, 3>& triangle, double slack, Frame& frame) {
  frame.centre = (triangle[0] + triangle[1] + triangle[2]) * (1.0 / 3.0);
  const std::array<Vec3, 3> corners = {triangle[0] - frame.centre, triangle[1] - frame.centre,
                                       triangle[2] - frame.centre};
  const double radius =
      std::sqrt(std::max({squared_length(corners[0]), squared_length(corners[1]), squared_length(corners[2])}));
  const Vec3 normal = normalized(cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
  if (!(squared_length(normal) > 0) || !(radius > slack)) return false;
  const double shrink = 1 - slack / radius;
  const auto set = [&frame](std::size_t i, const Vec3& direction, double constant) {
    frame.x_factors[i] = direction.x;
    frame.y_factors[i] = direction.y;
    frame.z_factors[i] = direction.z;
    frame.constants[i] = constant;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 inwards = cross(normal, corners[(i + 1) % 3] - corners[i]);
    set(i, inwards, -dot(corners[i], inwards) * shrink);
  }
  set(3, normal, 0);
  return true;
}

/// Whether a line along the edge from p to q, or along one of the triangle's, keeps the edge and the triangle apart.
bool PatchBound::is_apart(const Point& p, const Point& q) {
  if ((p.outside & q.outside) != 0) return true;
  return p.outside != 0 && q.outside != 0 && common_side(corners_beside(p.seen, q.seen)) != 0;
}

/// The same for a whole face.
bool PatchBound::is_apart(const Points& face) {
  if ((face[0].outside & face[1].outside & face[2].outside) != 0) return true;
  if (face[0].outside == 0 || face[1].outside == 0 || face[2].outside == 0) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::array<double, 3> beside = corners_beside(face[i].seen, face[(i + 1) % 3].seen);
    const std::array<double, 4>& apex = face[(i + 2) % 3].seen;
    const double apex_beside = beside[0] * apex[0] + beside[1] * apex[1] + beside[2] * apex[2];
    if (const int side = common_side(beside); side != 0 && apex_beside * side <= 0) return true;
  }
  return false;
}

/// Returns the greatest absolute height of that part of `subject` which lies over the triangle.
double PatchBound::clipped_height(const Points& subject) {
  using Corner = std::array<double, 4>;  // What is seen of a point changes evenly along an edge.
  constexpr std::size_t kMost = 9;       // 3, 4, 6, 9 at worst, however they are rounded.
  std::array<std::array<Corner, kMost>, 2> polygons;
  std::size_t size = 3, now = 0;
  for (std::size_t j = 0; j < size; ++j) polygons[0][j] = subject[j].seen;
  const unsigned outside = subject[0].outside | subject[1].outside | subject[2].outside;
  for (std::size_t i = 0; i < 3; ++i) {
    if ((outside >> i & 1) == 0) continue;
    const std::array<Corner, kMost>& polygon = polygons[now];
    now = 1 - now;
    std::array<Corner, kMost>& kept = polygons[now];
    std::size_t kept_size = 0;
    for (std::size_t j = 0; j < size; ++j) {
      const Corner& p = polygon[j];
      const Corner& q = polygon[j + 1 < size ? j + 1 : 0];
      const double at_p = p[i];
      const double at_q = q[i];
      if (at_p >= 0) kept[kept_size++] = p;
      if ((at_p >= 0) == (at_q >= 0)) continue;
      const double t = at_p / (at_p - at_q);
      Corner& cut = kept[kept_size++];
      for (std::size_t k = 0; k < 4; ++k) cut[k] = p[k] + (q[k] - p[k]) * t;
    }
    size = kept_size;
  }
  double height = 0;
  for (std::size_t j = 0; j < size; ++j) height = std::max(height, std::abs(polygons[now][j][3]));
  return height;
}

/// How the edge from p to q passes a ray from the triangle's centre, where its edges see the same: 1 to the left, −1 to
/// the right, 0 not at all.
int PatchBound::crossing(const Point& p, const Point& q) {
  const double p_along = p.seen[0] - p.seen[2], p_aside = p.seen[1] - p.seen[2];
  const double q_along = q.seen[0] - q.seen[2], q_aside = q.seen[1] - q.seen[2];
  if ((p_aside <= 0) == (q_aside <= 0)) return 0;
  const double left = p_along * q_aside - p_aside * q_along;
  return p_aside <= 0 ? (left > 0 ? 1 : 0) : (left < 0 ? -1 : 0);
}

PatchBound::Points PatchBound::project(const Frame& frame, Index face) const {
  return {frame.project(surface_.corner_position(3 * face)), frame.project(surface_.corner_position(3 * face + 1)),
          frame.project(surface_.corner_position(3 * face + 2))};
}

/// Starts the patch with a face, or where that is not over the triangle with one of those around it.
void PatchBound::start_patch(const Frame& frame, Index start) {
  const Points points = project(frame, start);
  if (start_with(start, points)) return;
  for (Index corner = 3 * start; corner < 3 * start + 3; ++corner)
    if (start_around(frame, corner, points)) return;
}

/// Starts with the first of the other faces around a corner that is over the triangle; `start` are the points of the
/// corner's face. False where none is, as far as the next border one way round.
bool PatchBound::start_around(const Frame& frame, Index corner, const Points& start) {
  Points points = start;
  for (Index at = corner; opposite_[at] != kNoIndex;) {
    const Index other = opposite_[at];
    const Point centre = points[at % 3], shared = points[next_corner(at) % 3];
    at = next_corner(other);
    if (at == corner) return false;
    points[at % 3] = centre;
    points[other % 3] = shared;
    points[previous_corner(other) % 3] = frame.project(surface_.corner_position(previous_corner(other)));
    if (start_with(face_of_corner(at), points)) return true;
  }
  return false;
}

bool PatchBound::start_with(Index face, const Points& points) {
  if (is_apart(points)) return false;
  last_.push_back({points});
  if (take(face)) return true;
  last_.pop_back();
  return false;
}

/// Grows the patch across those edges of one of its faces that enter the triangle; all others may be part of the
/// outline, and add to the winding: an edge of two faces of the patch takes away for one what it adds for the other.
/// False where the outline enters the triangle.
bool PatchBound::grow(const Frame& frame, Index face, const Taken& taken, int& winding) {
  for (Index i = 0; i < 3; ++i) {
    if (i == taken.entered) continue;
    const Point &p = taken.points[i], &q = taken.points[next_corner(i)];
    if (is_apart(p, q))
      winding += crossing(p, q);
    else if (!take_across(frame, face, taken.points, i))
      return false;
  }
  return true;
}

/// Takes the face beyond an edge of one of the patch, if there is one; `points` are that one's.
bool PatchBound::take_across(const Frame& frame, Index face, const Points& points, Index edge) {
  const Index other = opposite_[3 * face + edge];
  if (other == kNoIndex) return false;
  const Index beyond = face_of_corner(other);
  if (taken_in_[beyond] == run_) return true;
  const Index from = other - 3 * beyond, to = next_corner(from), apex = previous_corner(from);
  Taken& taken = last_.emplace_back();
  taken.entered = from;
  taken.points[from] = points[next_corner(edge)];
  taken.points[to] = points[edge];
  taken.points[apex] = frame.project(surface_.corner_position(3 * beyond + apex));
  return take(beyond);
}

/// Takes a face, whose points are there, into the patch if it is not too high over the triangle.
bool PatchBound::take(Index face) {
  const Points& points = last_.back().points;
  double height = std::max({std::abs(points[0].height()), std::abs(points[1].height()), std::abs(points[2].height())});
  if (height > close_from_ * limit_) height = clipped_height(points);
  if (height > limit_) return false;
  height_ = std::max(height_, height);
  taken_in_[face] = run_;
  patch_.push_back(face);
  return true;
}

double PatchBound::bound(const std::array<Vec3, 3>& triangle, Index start, double target, double slack) {
  patch_.clear();
  last_.clear();
  if (++run_ == 0) {
    std::fill(taken_in_.begin(), taken_in_.end(), run_);
    ++run_;
  }
  Frame frame;
  if (!make_frame(triangle, slack, frame)) return kNone;
  limit_ = target - slack;
  height_ = 0;
  start_patch(frame, start);
  int winding = 0;
  for (std::size_t i = 0; i < patch_.size();) {
    before_.swap(last_);
    last_.clear();
    for (const Taken& taken : before_)
      if (!grow(frame, patch_[i++], taken, winding)) return kNone;
  }
  return winding != 0 ? height_ + slack : kNone;
}

}  // namespace lodestone::detail

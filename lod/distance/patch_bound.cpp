// The degree of a map as a proof of coverage: see for instance J. Milnor, "Topology from the Differentiable Viewpoint",
// 1965, section 5. The degree of the patch's projection is constant where its outline does not go, and it is the
// winding number of the outline there.

#include "distance/patch_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::detail {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Twice the signed area of p, q, r.
template <class P, class Q, class R>
double area2(const P& p, const Q& q, const R& r) {
  return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

/// The half-edges of a mesh by the vertex they leave.
class HalfEdges {
 public:
  explicit HalfEdges(const Mesh& mesh) : begin_(mesh.vertex_count() + 1, 0), edges_(mesh.corner_wedge.size()) {
    const Index count = static_cast<Index>(mesh.corner_wedge.size());
    for (Index c = 0; c < count; ++c) ++begin_[mesh.corner_vertex(c)];
    Index sum = 0;
    for (Index& b : begin_) b = sum += b;
    // Filling from the back turns the ends into the beginnings.
    for (Index c = count; c-- > 0;) {
      edges_[--begin_[mesh.corner_vertex(c)]] = {mesh.corner_vertex(next_corner(c)), c};
    }
  }

  /// The corner of the half-edge from u to v; kNoIndex where there are none or several.
  Index only_corner(Index u, Index v) const {
    Index found = kNoIndex;
    for (Index i = begin_[u]; i < begin_[u + 1]; ++i) {
      if (edges_[i].to != v) continue;
      if (found != kNoIndex) return kNoIndex;
      found = edges_[i].corner;
    }
    return found;
  }

 private:
  struct HalfEdge {
    Index to;
    Index corner;
  };
  std::vector<Index> begin_;
  std::vector<HalfEdge> edges_;
};

}  // namespace

std::vector<Index> opposite_corners(const Mesh& mesh) {
  const HalfEdges half_edges(mesh);
  std::vector<Index> opposite(mesh.corner_wedge.size());
  for (Index c = 0; c < opposite.size(); ++c) {
    const Index u = mesh.corner_vertex(c);
    const Index v = mesh.corner_vertex(next_corner(c));
    // Both ways, so that the relation is symmetric: the outline of a patch is counted from both of its sides.
    opposite[c] = half_edges.only_corner(u, v) == c ? half_edges.only_corner(v, u) : kNoIndex;
  }
  return opposite;
}

PatchBound::PatchBound(const Mesh& surface, std::span<const Index> opposite)
    : surface_(surface), opposite_(opposite), state_(surface.face_count(), 0) {}

PatchBound::Point PatchBound::Frame::project(const Vec3& p) const {
  const Vec3 d = p - origin;
  Point point{dot(d, x_axis), dot(d, y_axis), dot(d, normal), {}, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    point.side[i] = edges[i].x_factor * point.x + edges[i].y_factor * point.y + edges[i].constant;
    point.outside |= static_cast<unsigned>(point.side[i] <= 0) << i;
  }
  return point;
}

/// Sets up the plane of a triangle; false where it has none.
bool PatchBound::make_frame(const std::array<Vec3, 3>& triangle, double slack, Frame& frame) {
  const Vec3 centre = (triangle[0] + triangle[1] + triangle[2]) * (1.0 / 3.0);
  double squared_radius = 0;
  for (const Vec3& corner : triangle) squared_radius = std::max(squared_radius, squared_length(corner - centre));
  const double radius = std::sqrt(squared_radius);
  frame.origin = centre;
  frame.x_axis = triangle[1] - triangle[0];
  frame.normal = normalized(cross(frame.x_axis, triangle[2] - triangle[0]));
  frame.y_axis = cross(frame.normal, frame.x_axis);
  if (!(squared_length(frame.normal) > 0) || !(radius > slack)) return false;
  const double shrink = 1 - slack / radius;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 d = (triangle[i] - centre) * shrink;
    frame.corners[i] = {dot(d, frame.x_axis), dot(d, frame.y_axis)};
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Frame::Corner &p = frame.corners[i], &q = frame.corners[(i + 1) % 3];
    frame.edges[i] = {p.y - q.y, q.x - p.x, p.x * q.y - q.x * p.y};
  }
  return true;
}

/// Whether a line along an edge of `other` or of the triangle keeps the two apart.
bool PatchBound::separated(const Frame& frame, const Points& other) {
  if ((other[0].outside & other[1].outside & other[2].outside) != 0) return true;
  if (other[0].outside == 0 || other[1].outside == 0 || other[2].outside == 0) return false;
  return edge_separates(frame, other);
}

bool PatchBound::edge_separates(const Frame& frame, const Points& other) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Point& p = other[i];
    const Point& q = other[(i + 1) % 3];
    if (p.x == q.x && p.y == q.y) continue;  // No line: a border edge comes as a triangle of two points.
    const double inner = area2(p, q, other[(i + 2) % 3]);
    const double a = area2(p, q, frame.corners[0]);
    const double b = area2(p, q, frame.corners[1]);
    const double c = area2(p, q, frame.corners[2]);
    if ((inner >= 0 && a <= 0 && b <= 0 && c <= 0) || (inner <= 0 && a >= 0 && b >= 0 && c >= 0)) return true;
  }
  return false;
}

/// Returns the greatest absolute height of that part of `subject` which lies over the triangle.
double PatchBound::clipped_height(const Points& subject) {
  // All that is needed of a point changes evenly along an edge: its height, and then what it sees of the edges.
  using Corner = std::array<double, 4>;
  constexpr std::size_t kMost = 9;  // 3, 4, 6, 9 at worst, however they are rounded.
  std::array<std::array<Corner, kMost>, 2> polygons;
  std::size_t size = 3;
  for (std::size_t j = 0; j < size; ++j) {
    const Point& p = subject[j];
    polygons[0][j] = {p.height, p.side[0], p.side[1], p.side[2]};
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::array<Corner, kMost>& polygon = polygons[i % 2];
    std::array<Corner, kMost>& kept = polygons[(i + 1) % 2];
    std::size_t kept_size = 0;
    for (std::size_t j = 0; j < size; ++j) {
      const Corner& p = polygon[j];
      const Corner& q = polygon[j + 1 < size ? j + 1 : 0];
      const double at_p = p[1 + i];
      const double at_q = q[1 + i];
      if (at_p >= 0) kept[kept_size++] = p;
      if ((at_p >= 0) == (at_q >= 0)) continue;
      const double t = at_p / (at_p - at_q);
      Corner& cut = kept[kept_size++];
      for (std::size_t k = 0; k < 4; ++k) cut[k] = p[k] + (q[k] - p[k]) * t;
    }
    size = kept_size;
  }
  double height = 0;
  for (std::size_t j = 0; j < size; ++j) height = std::max(height, std::abs(polygons[1][j][0]));
  return height;
}

/// How the edge from p to q passes the ray along x from the origin, the triangle's centre: 1 upwards, −1 downwards, 0
/// not at all.
int PatchBound::crossing(const Point& p, const Point& q) {
  const bool p_below = p.y <= 0;
  const bool q_below = q.y <= 0;
  if (p_below == q_below) return 0;
  const bool left = p.x * q.y - p.y * q.x > 0;
  return p_below ? (left ? 1 : 0) : (left ? 0 : -1);
}

PatchBound::Points PatchBound::project(const Frame& frame, Index face) const {
  return {frame.project(surface_.corner_position(3 * face)), frame.project(surface_.corner_position(3 * face + 1)),
          frame.project(surface_.corner_position(3 * face + 2))};
}

/// What the face is to the triangle; it joins the patch if it is over or under it, and not too high.
PatchBound::Standing PatchBound::add_if_over(const Frame& frame, Index face) {
  return was_tested(face) ? standing(face) : add_tested(frame, face, project(frame, face));
}

/// The same for the face of the corner `other`, two of whose corners are known: those of its edge.
PatchBound::Standing PatchBound::add_across(const Frame& frame, Index other, const Point& at_other,
                                            const Point& after_other) {
  const Index face = face_of_corner(other);
  if (was_tested(face)) return standing(face);
  Points points;
  points[other % 3] = at_other;
  points[next_corner(other) % 3] = after_other;
  points[previous_corner(other) % 3] = frame.project(surface_.corner_position(previous_corner(other)));
  return add_tested(frame, face, points);
}

PatchBound::Standing PatchBound::add_tested(const Frame& frame, Index face, const Points& points) {
  const Standing standing = judge(frame, points);
  state_[face] = kStandings * run_ + static_cast<std::uint32_t>(standing);
  if (standing != Standing::InPatch) return standing;
  patch_.push_back(face);
  points_.push_back(points);
  return standing;
}

PatchBound::Standing PatchBound::judge(const Frame& frame, const Points& points) {
  if (separated(frame, points)) return Standing::Apart;
  double height = std::max({std::abs(points[0].height), std::abs(points[1].height), std::abs(points[2].height)});
  if (height > limit_) height = clipped_height(points);
  if (height > limit_) return Standing::TooHigh;
  height_ = std::max(height_, height);
  return Standing::InPatch;
}

/// Starts the patch with a face, or where that is not over the triangle with one of those around it.
void PatchBound::start_patch(const Frame& frame, Index start) {
  const auto starts = [&](Index face) { return add_if_over(frame, face) == Standing::InPatch; };
  if (starts(start)) return;
  for (Index corner = 3 * start; corner < 3 * start + 3; ++corner)
    if (any_face_around(opposite_, corner, starts)) return;
}

/// Grows the patch across the face's edges; where an edge is part of the outline, checks it and adds up the winding.
/// False where the outline enters the triangle.
bool PatchBound::visit_outline(const Frame& frame, Index face, const Points& points, int& winding) {
  for (Index i = 0; i < 3; ++i) {
    const Index j = (i + 1) % 3;
    const Index other = opposite_[3 * face + i];
    const Standing beyond = other == kNoIndex ? Standing::TooHigh : add_across(frame, other, points[j], points[i]);
    if (beyond == Standing::InPatch) continue;
    // A face apart from the triangle has edges that are, too.
    if (beyond != Standing::Apart && !separated(frame, {points[i], points[j], points[j]})) return false;
    winding += crossing(points[i], points[j]);
  }
  return true;
}

double PatchBound::bound(const std::array<Vec3, 3>& triangle, Index start, double target, double slack) {
  patch_.clear();
  points_.clear();
  ++run_;
  Frame frame;
  if (!make_frame(triangle, slack, frame)) return kNone;
  limit_ = target - slack;
  height_ = 0;
  start_patch(frame, start);
  int winding = 0;
  for (std::size_t i = 0; i < patch_.size(); ++i) {
    const Points points = points_[i];
    if (!visit_outline(frame, patch_[i], points, winding)) return kNone;
  }
  return winding != 0 ? height_ + slack : kNone;
}

}  // namespace lodestone::detail

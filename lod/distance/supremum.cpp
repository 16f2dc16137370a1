// The supremum of the distance from a triangle mesh to a surface by branch and bound, in the spirit of
// M. Tang, M. Lee, Y. J. Kim, "Interactive Hausdorff distance computation for general polygonal models", ACM
// Transactions on Graphics 28(3), 2009, and of M. Guthe, P. Borodin, R. Klein, "Fast and accurate Hausdorff distance
// calculation between meshes", Journal of WSCG 13(2), 2005.
//
// The bound of a part rests on one fact: the distance to a *convex* set is a convex function, so that its largest
// value over a part is at a corner. Any single face therefore bounds the whole part. Where no single face will do,
// the part is cut in two, each half bounded by a face of its own; the cut goes where the two distances agree, which on
// a plane is their common edge and between two planes their bisector.

#include "distance/supremum.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "distance/patch_distance.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kFacesOfStep = 256;  // looked at between two words about the progress

// Parts of a face that is bounded by no patch seldom are until they are much smaller, and over large ones patches are
// dear: one is looked for after so many halvings, and then after as many again.
constexpr int kHalvingsToPatch = 3;

// Where bounds may be above what was found by so much, one face mostly bounds another, if it is the one at its centre,
// and it is found in a fraction of the time of a patch.
constexpr double kLooseTolerance = 0.05;

using Corners = std::array<PartCorner, 3>;
using Distances = std::array<double, 3>;  // From the three corners to one face.

double largest(const Distances& d) { return std::max({d[0], d[1], d[2]}); }

/// The bound from the corners' distances alone, which grow by no more than the way from a corner.
double bound_by_length(const Corners& c) {
  const double e01 = length(c[0].point - c[1].point);
  const double e12 = length(c[1].point - c[2].point);
  const double e20 = length(c[2].point - c[0].point);
  // No point of a triangle is farther from its nearest corner than the circumradius of the equilateral one.
  const double reach = std::max({e01, e12, e20}) / std::numbers::sqrt3;
  const double from_nearest = std::max({c[0].distance, c[1].distance, c[2].distance}) + reach;
  return std::min({from_nearest, c[0].distance + std::max(e01, e20), c[1].distance + std::max(e01, e12),
                   c[2].distance + std::max(e12, e20)});
}

bool all_near_faces(const Corners& c) {
  return c[0].face != kNoIndex && c[1].face != kNoIndex && c[2].face != kNoIndex;
}

bool two_share_face(const Corners& c) {
  return c[0].face == c[1].face || c[1].face == c[2].face || c[2].face == c[0].face;
}

/// The bound where one face is known to be near all corners; infinity elsewhere.
double bound_by_same_face(const Corners& c) {
  const bool same = c[0].face != kNoIndex && c[0].face == c[1].face && c[0].face == c[2].face;
  return same ? std::max({c[0].distance, c[1].distance, c[2].distance}) : kUnbounded;
}

Vec3 centre_of(const Corners& c) { return (c[0].point + c[1].point + c[2].point) * (1.0 / 3.0); }

/// Where a difference that is `from` at one end and `towards`, of the other sign, at the other end vanishes.
double zero_between(double from, double towards) {
  const double range = from - towards;
  return range != 0 ? std::clamp(from / range, 0.0, 1.0) : 0.5;
}

/// An upper bound of the distances from a part to a surface; every face tried can only lower it.
class PieceBound {
 public:
  PieceBound(const Corners& corners, const TargetSurface& to, double target)
      : corners_(corners), to_(to), target_(target), value_(bound_by_length(corners)) {}

  double value() const { return value_; }
  bool met() const { return value_ <= target_; }

  /// Tries one more face: for the whole part, and for a part of it beside each face tried before.
  void try_face(Index face) {
    if (face == kNoIndex || met()) return;
    for (std::size_t i = 0; i < count_; ++i) {
      if (tried_[i].face == face) return;
    }
    const Candidate candidate{face, distances_to(face)};
    value_ = std::min(value_, largest(candidate.distances));
    for (std::size_t i = 0; i < count_ && !met(); ++i) try_cut(tried_[i], candidate);
    tried_[count_++] = candidate;
  }

 private:
  struct Candidate {
    Index face = kNoIndex;
    Distances distances{};
  };

  Distances distances_to(Index face) const {
    Distances d;
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = corners_[i].face == face ? corners_[i].distance : to_.distance_to_face(corners_[i].point, face);
    }
    return d;
  }

  /// Cuts the part along the line where its distances to two faces seem to agree.
  void try_cut(const Candidate& g, const Candidate& h) {
    double bound = 0;
    for (std::size_t i = 0; i < 3; ++i) bound = std::max(bound, std::min(g.distances[i], h.distances[i]));
    for (std::size_t i = 0; i < 3 && bound < value_; ++i) {
      const std::size_t j = (i + 1) % 3;
      const double at_i = g.distances[i] - h.distances[i];
      const double at_j = g.distances[j] - h.distances[j];
      if ((at_i <= 0) == (at_j <= 0)) continue;
      const Vec3 cut = corners_[i].point + (corners_[j].point - corners_[i].point) * zero_between(at_i, at_j);
      bound = std::max({bound, to_.distance_to_face(cut, g.face), to_.distance_to_face(cut, h.face)});
    }
    value_ = std::min(value_, bound);
  }

  const Corners& corners_;
  const TargetSurface& to_;
  double target_;
  double value_;
  std::size_t count_ = 0;
  std::array<Candidate, 4> tried_;
};

}  // namespace

void SurfaceBounds::lower(Index face, double bound, std::span<const Index> found) {
  if (bound >= faces[face]) return;
  faces[face] = bound;
  if (witnesses.empty()) return;
  lowered[face] = true;
  Witnesses& witness = witnesses[face];
  witness = {};
  if (found.empty() || found.size() > witness.faces.size()) return;
  if (std::find(found.begin(), found.end(), kNoIndex) != found.end()) return;
  witness.faces.fill(found[0]);
  std::copy(found.begin(), found.end(), witness.faces.begin());
}

void SurfaceBounds::begin_anew(Index face) {
  faces[face] = 0;
  if (witnesses.empty()) return;
  lowered[face] = true;
  witnesses[face] = {};
}

SupremumSearch::SupremumSearch(const Mesh& from, TargetSurface& to, PatchBound& to_patch, SurfaceBounds& bounds)
    : from_(from), to_(to), to_patch_(to_patch), bounds_(bounds) {}

void SupremumSearch::scout(std::size_t count, Goal& goal) {
  const std::size_t step = std::max<std::size_t>(from_.face_count() / std::max<std::size_t>(count, 1), 1);
  for (std::size_t face = 0; face < from_.face_count(); face += step) query_one_vertex(static_cast<Index>(face), goal);
}

void SupremumSearch::visit_vertices(Goal& goal) {
  const Index count = static_cast<Index>(from_.face_count());
  for (Index face = 0; face < count; ++face) {
    if (!is_open(face, goal)) continue;
    visit_face(face, goal);
    goal.step();
  }
}

/// Bounds a face by the cheapest means that will do. Vertices come first: what they know serves all faces around them.
void SupremumSearch::visit_face(Index face, Goal& goal) {
  bool patch_tried = false;
  do {
    const Corners corners = corners_of(face);
    const std::array<Index, 3> nearest = {corners[0].face, corners[1].face, corners[2].face};
    bounds_.lower(face, std::min(bound_by_length(corners), bound_by_same_face(corners)), nearest);
    if (!all_near_faces(corners)) continue;
    // Two faces often do, three seldom: then the patch, which is dearer, is tried first.
    const bool corners_first = !patch_tried && two_share_face(corners);
    if (corners_first && is_open(face, goal)) bounds_.lower(face, bound_by_corners(corners, goal), nearest);
    if (is_open(face, goal) && !patch_tried && goal.relative_tolerance >= kLooseTolerance) {
      const Index facing = face_facing(corners);
      bounds_.lower(face, bound_by_face(corners, facing, goal), std::span(&facing, 1));
    }
    if (is_open(face, goal) && !patch_tried) {
      patch_tried = true;
      const double bound = bound_by_patch(corners, goal);
      bounds_.lower(face, bound, to_patch_.patch());
    }
    if (!corners_first && is_open(face, goal)) bounds_.lower(face, bound_by_corners(corners, goal), nearest);
  } while (is_open(face, goal) && query_one_vertex(face, goal));
}

double SupremumSearch::bound_by_corners(const Corners& corners, const Goal& goal) const {
  PieceBound bound(corners, to_, goal.threshold());
  for (const PartCorner& corner : corners) bound.try_face(corner.face);
  return bound.value();
}

/// A face near the middle of a part. Pre: all corners are near faces.
Index SupremumSearch::face_facing(const Corners& c) const { return to_.near(centre_of(c), c[0].face).face; }

double SupremumSearch::bound_by_face(const Corners& corners, Index face, const Goal& goal) const {
  PieceBound bound(corners, to_, goal.threshold());
  bound.try_face(face);
  return bound.value();
}

/// Starts where two corners are near one face, if so: it is seldom beside the part. Pre: all corners are near faces.
double SupremumSearch::bound_by_patch(const Corners& c, const Goal& goal) {
  const Index start = c[1].face == c[2].face ? c[1].face : c[0].face;
  return to_patch_.bound({c[0].point, c[1].point, c[2].point}, start, goal.threshold(), goal.patch_slack());
}

/// Finds the nearest face of one of the face's vertices, first of those that know none; false where all are known.
bool SupremumSearch::query_one_vertex(Index face, Goal& goal) {
  Index hint = kNoIndex;
  Index vertex = kNoIndex;
  for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
    const Index v = from_.corner_vertex(corner);
    const KnownDistance& known = bounds_.vertices[v];
    if (known.face != kNoIndex) hint = known.face;
    if (known.searched) continue;
    if (vertex == kNoIndex || known.face == kNoIndex || known.is_hint) vertex = v;
  }
  if (vertex == kNoIndex) return false;
  if (bounds_.vertices[vertex].face != kNoIndex) hint = bounds_.vertices[vertex].face;
  const PartCorner nearest = query(Vec3(from_.positions[vertex]), hint, face, goal);
  bounds_.vertices[vertex] = {nearest.distance, nearest.face, true};
  return true;
}

/// Only a point that may be the farthest of all needs the nearest face: for all others one that is near enough will do.
PartCorner SupremumSearch::query(const Vec3& point, Index hint, Index from_face, Goal& goal) {
  if (hint != kNoIndex) {
    const NearFace found = to_.near(point, hint);
    if (found.distance <= goal.found) return {point, found.distance, found.face};
    hint = found.face;
  }
  const NearFace nearest = to_.nearest(point, hint);
  if (nearest.distance > largest_distance_) {
    assume(from_face, nearest.distance, goal);
    farthest_point_ = point;
  }
  return {point, nearest.distance, nearest.face};
}

void SupremumSearch::assume(Index face, double distance, Goal& goal) {
  largest_distance_ = distance;
  farthest_face_ = face;
  goal.found = std::max(goal.found, distance);
}

OneSidedDeviation SupremumSearch::result() const {
  OneSidedDeviation result;
  result.maximum = largest_distance_;
  result.maximum_bound = std::max(bounds_.maximum(), largest_distance_) * kRoundingSlack;
  return result;
}

Corners SupremumSearch::corners_of(Index face) const {
  Corners corners;
  for (Index i = 0; i < 3; ++i) {
    const Index vertex = from_.corner_vertex(3 * face + i);
    const KnownDistance& known = bounds_.vertices[vertex];
    corners[i] = {Vec3(from_.positions[vertex]), known.distance, known.is_hint ? kNoIndex : known.face};
  }
  return corners;
}

void SupremumSearch::split_faces(Goal& goal, std::size_t budget) {
  const Index count = static_cast<Index>(from_.face_count());
  for (Index face = 0; face < count; ++face) {
    if (!is_open(face, goal)) continue;
    add_face(face, goal);
    goal.step();
  }
  for (; budget > 0 && !heap_.empty() && heap_.front().bound > goal.threshold(); --budget) {
    split(pop(), goal);
    goal.step();
  }
  for (const Part& part : heap_) bounds_.faces[part.face] = std::max(bounds_.faces[part.face], part.bound);
  heap_.clear();
  corners_.clear();
}

/// Turns a face into a part; from here on the face's bound is the largest of its finished parts.
void SupremumSearch::add_face(Index face, Goal& goal) {
  while (query_one_vertex(face, goal)) {
  }
  const Index first = static_cast<Index>(corners_.size());
  const Corners corners = corners_of(face);
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  const double bound = bounds_.faces[face];
  bounds_.begin_anew(face);
  add_part({bound, {}, face, 0}, {first, first + 1, first + 2}, goal);
}

void SupremumSearch::add_part(const Part& parent, const std::array<Index, 3>& corners, Goal& goal) {
  const Corners c = {corners_[corners[0]], corners_[corners[1]], corners_[corners[2]]};
  PieceBound by_faces(c, to_, goal.threshold());
  for (const PartCorner& corner : c) by_faces.try_face(corner.face);
  double bound = std::min(parent.bound, by_faces.value());
  if (bound > goal.threshold() && parent.halvings % kHalvingsToPatch == kHalvingsToPatch - 1)
    bound = std::min(bound, bound_by_patch(c, goal));
  if (bound > goal.threshold()) {
    by_faces.try_face(face_at_centre(c, parent.face, goal));
    bound = std::min(bound, by_faces.value());
  }
  const Part part{bound, corners, parent.face, parent.halvings + 1};
  if (part.bound > goal.threshold()) {
    push(part);
  } else {
    bounds_.faces[part.face] = std::max(bounds_.faces[part.face], part.bound);
  }
}

/// At the corners several faces may be equally near, and the one that covers the part need not be the one found: the
/// face nearest to the centre is worth trying as well.
Index SupremumSearch::face_at_centre(const Corners& c, Index from_face, Goal& goal) {
  return query(centre_of(c), c[0].face, from_face, goal).face;
}

/// Halves a part across its longest edge.
void SupremumSearch::split(const Part& part, Goal& goal) {
  std::size_t longest = 0;
  double longest_squared = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = corners_[part.corners[(i + 1) % 3]].point - corners_[part.corners[i]].point;
    if (squared_length(edge) > longest_squared) longest = i, longest_squared = squared_length(edge);
  }
  const Index a = part.corners[longest];
  const Index b = part.corners[(longest + 1) % 3];
  const Index c = part.corners[(longest + 2) % 3];
  const Index middle = static_cast<Index>(corners_.size());
  const Vec3 point = (corners_[a].point + corners_[b].point) * 0.5;
  corners_.push_back(query(point, corners_[a].face, part.face, goal));
  add_part(part, {a, middle, c}, goal);
  add_part(part, {middle, b, c}, goal);
}

void SupremumSearch::push(const Part& part) {
  heap_.push_back(part);
  std::push_heap(heap_.begin(), heap_.end(), [](const Part& a, const Part& b) { return a.bound < b.bound; });
}

SupremumSearch::Part SupremumSearch::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), [](const Part& a, const Part& b) { return a.bound < b.bound; });
  const Part part = heap_.back();
  heap_.pop_back();
  return part;
}

Goal goal_of(const DeviationOptions& options, double diagonal, double enough) {
  Goal goal;
  goal.relative_tolerance = options.relative_tolerance;
  goal.absolute_tolerance = options.absolute_tolerance;
  if (!(goal.absolute_tolerance > 0)) goal.absolute_tolerance = 1e-7 * diagonal;
  goal.enough = enough;
  goal.steps = {options.progress.part(0), 0, kFacesOfStep};
  return goal;
}

Deviation narrow_both(SupremumSearch& forward, SupremumSearch& backward, Goal goal, std::size_t budget) {
  // Vertices first, both ways: what they find raises the threshold before anything is split.
  forward.visit_vertices(goal);
  backward.visit_vertices(goal);
  forward.split_faces(goal, budget);
  backward.split_faces(goal, budget);
  Deviation result;
  result.forward = forward.result();
  result.backward = backward.result();
  return result;
}

Deviation maximum_of_empty(const Mesh& a, const Mesh& b) {
  Deviation result;
  if (a.face_count() == 0 && b.face_count() == 0) return result;
  result.forward.maximum = result.forward.maximum_bound = kUnbounded;
  result.backward = result.forward;
  return result;
}

}  // namespace lodestone::detail

// Descends from face to face, as locating a point by walking does in a triangulation (see O. Devillers, S. Pion,
// M. Teillaud: Walking in a triangulation, 2002). Where the point lies over the inside of a face, which most do, the
// foot of its perpendicular is the answer unless the surface folds up towards it; elsewhere the walk goes on over the
// edge that the point lies beyond, and ends there if it would come back over it. Around corners and in folds what falls
// is the distance, over those faces that share what the nearest point lies on.

#include "distance/surface_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/detail/position_index.h>

namespace lodestone::detail {
namespace {

constexpr int kMostSteps = 32;          // over edges that a point lies beyond, before distances are compared
constexpr double kRounding = 1 + 1e-5;  // of squared distances in single precision

/// Links numbers that are in one group, each to the next one and the last to the first.
std::vector<Index> circles(std::span<const Index> group_of, std::size_t group_count) {
  std::vector<Index> next(group_of.size()), last(group_count, kNoIndex);
  for (Index i = 0; i < next.size(); ++i) {
    Index& before = last[group_of[i]];
    next[i] = before != kNoIndex ? std::exchange(next[before], i) : i;
    before = i;
  }
  return next;
}

}  // namespace

SurfaceWalk::SurfaceWalk(const Mesh& mesh) : mesh_(&mesh), across_(mesh.corner_wedge.size()) {
  const std::vector<Index> place_of_vertex = places_of(mesh.positions);
  std::vector<Index> place(mesh.corner_wedge.size());
  for (Index c = 0; c < place.size(); ++c) place[c] = place_of_vertex[mesh.corner_vertex(c)];
  for_each_edge(sorted_edges(place), [&](Edge edge) {
    for (std::size_t i = 0; i < edge.size(); ++i) across_[edge[i].corner] = edge[(i + 1) % edge.size()].corner;
  });
  around_ = circles(place, mesh.vertex_count());
  update(mesh);
}

void SurfaceWalk::update(const Mesh& mesh) {
  mesh_ = &mesh;
  slabs_.resize(mesh.face_count());
  for (Index f = 0; f < slabs_.size(); ++f) slabs_[f] = slab_of(f);
  for (Index f = 0; f < slabs_.size(); ++f) add_neighbours(f);
}

/// Inlined, its loops would be taken apart into lanes again by what asks for one of them.
[[gnu::noinline]] SurfaceWalk::Lie SurfaceWalk::Lie::of(const Vec3& p, const Slab& slab) {
  const Vec3 from_origin = p - Vec3(slab.origin());
  const auto [px, py, pz] = to_float(from_origin);
  Lie lie;
  for (std::size_t i = 0; i < 4; ++i)
    lie.distance[i] = slab.x[i] * px + slab.y[i] * py + slab.z[i] * pz + slab.offset[i];
  const float height = lie.distance[3];
  for (std::size_t i = 0; i < 4; ++i) lie.slack[i] = lie.distance[i] * slab.run[i] - height * slab.rise[i];
  return lie;
}

/// Returns a face's slab without what depends on its neighbours.
SurfaceWalk::Slab SurfaceWalk::slab_of(Index face) const {
  const Triangle triangle = triangle_of(*mesh_, face);
  const Vec3 corners[3] = {Vec3(triangle.a), Vec3(triangle.b), Vec3(triangle.c)};
  const Vec3 area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double twice_area = length(area);
  Slab slab{};
  slab.set_origin(triangle.a);
  const auto set = [&](std::size_t k, const Vec3& direction, double offset) {
    slab.x[k] = static_cast<float>(direction.x);
    slab.y[k] = static_cast<float>(direction.y);
    slab.z[k] = static_cast<float>(direction.z);
    slab.offset[k] = static_cast<float>(offset);
  };
  const Vec3 normal = area * (1 / twice_area);
  if (!has_direction(normal)) return slab;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = corners[(k + 1) % 3] - corners[k];
    const double inverse_length = 1 / length(edge);
    const Vec3 inwards = cross(normal, edge) * inverse_length;
    set(k, inwards, dot(corners[0] - corners[k], inwards));
    slab.inverse_height[k] = static_cast<float>(1 / (twice_area * inverse_length));
  }
  set(3, normal, 0);
  return slab;
}

/// Notes how the faces beyond a face's edges fold. Where several lie there a point over the edge is for comparing
/// distances.
void SurfaceWalk::add_neighbours(Index face) {
  Slab& slab = slabs_[face];
  for (Index k = 0; k < 3; ++k) {
    const Index corner = 3 * face + k;
    if (across_[corner] == corner) continue;
    if (!has_one_across(corner)) {
      slab.rise[k] = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    const Vec3 beyond = mesh_->corner_position(previous_corner(across_[corner]));
    const std::array<float, 4> distances = Lie::of(beyond, slab).distance;
    slab.rise[k] = distances[3];
    slab.run[k] = -distances[k];
  }
}

SurfaceWalk::Place SurfaceWalk::nearest_from(const Vec3& p, Index face) const {
  Place place;
  Index reached = face;
  if (walk_over(p, reached, place)) return place;
  Candidate best = look_at(p, face);
  if (reached != face) try_face(p, reached, best);
  for (Index before = kNoIndex; best.face != before;) {
    before = best.face;
    try_around(p, best);
  }
  return {best.face, weights_at(best.point, triangle_of(*mesh_, best.face), best.squared_distance)};
}

/// Goes on over edges that the point lies beyond. True where it comes to a face that the point lies over, no farther
/// away than the first one, and no neighbour of that can have a nearer point: for that it must fold up so far that the
/// point lies before it. True, too, where it comes to an edge with nothing beyond, or one that it would come back over,
/// and lands on it. `face` is where the walk has come to.
bool SurfaceWalk::walk_over(const Vec3& p, Index& face, Place& place) const {
  float least = std::numeric_limits<float>::infinity();  // no nearer is the first face, squared
  Index left_by = kNoIndex;                              // the corner of the edge that the face before was left over
  for (int step = 0; step < kMostSteps; ++step) {
    const Slab& slab = slabs_[face];
    if (!slab.has_area()) return false;
    const Lie lie = Lie::of(p, slab);
    const std::array<float, 4>& d = lie.distance;
    const std::size_t k = d[0] <= d[1] ? (d[0] <= d[2] ? 0 : 2) : (d[1] <= d[2] ? 1 : 2);
    const float squared = d[3] * d[3];
    if (d[k] >= 0) {
      Index nearer = kNoIndex;
      if (squared > least || !look_into_folds(p, face, lie, nearer)) return false;
      if (nearer != kNoIndex) {
        face = nearer, left_by = kNoIndex;
        continue;
      }
      place.face = face;
      place.on.squared_distance = static_cast<double>(squared);
      for (std::size_t i = 0; i < 3; ++i)
        place.on.weights[(i + 2) % 3] = static_cast<double>(d[i] * slab.inverse_height[i]);
      return true;
    }
    if (step == 0) least = squared + d[k] * d[k];
    const Index corner = 3 * face + static_cast<Index>(k), other = across_[corner];
    // At a border, and where both faces at an edge have the point beyond it, it is the edge that is nearest.
    if (other == corner || other == left_by) return land_on_edge(p, corner, least, place);
    if (across_[other] != corner) return false;
    left_by = corner;
    face = face_of_corner(other);
  }
  return false;
}

/// Looks at the faces beyond a face that the point lies over which fold up so far that it lies before them, too. False
/// where they do not tell what is nearest; `nearer` is the nearest of those that are nearer, and that it lies over.
bool SurfaceWalk::look_into_folds(const Vec3& p, Index face, const Lie& lie, Index& nearer) const {
  float least = lie.distance[3] * lie.distance[3];
  for (std::size_t k = 0; k < 3; ++k) {
    if (lie.slack[k] >= 0) continue;
    const Index corner = 3 * face + static_cast<Index>(k);
    if (!has_one_across(corner)) return false;
    const Index other = face_of_corner(across_[corner]);
    if (!slabs_[other].has_area()) return false;
    const std::array<float, 4> d = Lie::of(p, slabs_[other]).distance;
    const float beyond = std::min({d[0], d[1], d[2], 0.0F});
    const float at_least = d[3] * d[3] + beyond * beyond;
    if (at_least >= least) continue;
    if (beyond < 0) return false;
    least = at_least;
    nearer = other;
  }
  return true;
}

/// Takes the nearest point of the edge that leaves a corner, which the point lies beyond; false where that is an end of
/// the edge, or farther away than the first face may be.
bool SurfaceWalk::land_on_edge(const Vec3& p, Index corner, float least, Place& place) const {
  const Index face = face_of_corner(corner), k = corner % 3, next = next_corner(corner) % 3;
  const Triangle triangle = triangle_of(*mesh_, face);
  const std::array<Vec3, 3> corners = {Vec3(triangle.a), Vec3(triangle.b), Vec3(triangle.c)};
  const Vec3 from = corners[k], edge = corners[next] - from;
  const double along = dot(p - from, edge), whole = squared_length(edge);
  if (!(along > 0) || !(along < whole)) return false;
  const double t = along / whole, squared = squared_length(p - (from + edge * t));
  if (squared > static_cast<double>(least) * kRounding) return false;
  place.face = face;
  place.on.squared_distance = squared;
  place.on.weights[k] = 1 - t;
  place.on.weights[next] = t;
  place.on.weights[3 - k - next] = 0;
  return true;
}

SurfaceWalk::Candidate SurfaceWalk::look_at(const Vec3& p, Index face) const {
  const NearestPoint nearest = nearest_in_triangle(p, triangle_of(*mesh_, face));
  return {face, nearest.point, nearest.corners, squared_length(p - nearest.point)};
}

void SurfaceWalk::try_face(const Vec3& p, Index face, Candidate& best) const {
  if (face == best.face || is_no_nearer(triangle_of(*mesh_, face), best.point, p)) return;
  const Candidate there = look_at(p, face);
  if (there.squared_distance < best.squared_distance) best = there;
}

/// Tries the faces beyond the edge that leaves a corner.
void SurfaceWalk::try_across(const Vec3& p, Index corner, Candidate& best) const {
  for (Index other = across_[corner]; other != corner; other = across_[other]) try_face(p, face_of_corner(other), best);
}

/// Tries the faces at the position of a corner, in their order.
void SurfaceWalk::try_at_corner(const Vec3& p, Index corner, Candidate& best) const {
  while (around_[corner] > corner) corner = around_[corner];
  const Index first = around_[corner];
  Index at = first;
  do {
    try_face(p, face_of_corner(at), best);
    at = around_[at];
  } while (at != first);
}

/// Tries the faces that share what the best point lies on, an edge or a corner; where it lies inside of a face, those
/// beyond its edges, which may be nearer in a fold.
void SurfaceWalk::try_around(const Vec3& p, Candidate& best) const {
  const Index first = 3 * best.face;
  switch (best.corners) {
    case 0b001:
    case 0b010:
    case 0b100:
      try_at_corner(p, first + best.corners / 2, best);
      break;
    case 0b011:
      try_across(p, first, best);
      break;
    case 0b110:
      try_across(p, first + 1, best);
      break;
    case 0b101:
      try_across(p, first + 2, best);
      break;
    default:
      for (Index k = 0; k < 3; ++k) try_across(p, first + k, best);
  }
}

}  // namespace lodestone::detail

#include "distance/target_surface.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "distance/patch_bound.h"
#include "distance/triangle.h"

namespace lodestone::detail {
double TargetSurface::distance_to_face(const Vec3& p, Index face) const {
  return std::sqrt(look_at(p, face).squared_distance);
}

NearFace TargetSurface::near(const Vec3& p, Index start) const {
  Place place = look_at(p, start);
  while (step_across(p, place) || step_around(p, place)) {
  }
  return {place.face, std::sqrt(place.squared_distance)};
}

TargetSurface::Place TargetSurface::look_at(const Vec3& p, Index face) const {
  const NearestPoint nearest = nearest_in_triangle(p, triangle_of(mesh_, face));
  return {face, nearest.corners, squared_length(p - nearest.point)};
}

/// Steps to a face if that is nearer.
bool TargetSurface::step_to(const Vec3& p, Index face, Place& place) const {
  const Place other = look_at(p, face);
  if (other.squared_distance >= place.squared_distance) return false;
  place = other;
  return true;
}

/// Steps to the first of the faces beyond the edges that is nearer. The nearest point may lie on an edge: then the one
/// beyond that is looked at alone.
bool TargetSurface::step_across(const Vec3& p, Place& place) const {
  for (Index k = 0; k < 3; ++k) {
    const unsigned edge = 1U << k | 1U << next_corner(k);
    const Index other = opposite_[3 * place.face + k];
    if ((place.corners & ~edge) == 0 && other != kNoIndex && step_to(p, face_of_corner(other), place)) return true;
  }
  return false;
}

/// Where the nearest point is a corner, steps to the first face around it that is nearer.
bool TargetSurface::step_around(const Vec3& p, Place& place) const {
  if (std::popcount(place.corners) != 1) return false;
  const Index corner = 3 * place.face + static_cast<Index>(std::countr_zero(place.corners));
  return any_face_around(opposite_, corner, [&](Index face) { return step_to(p, face, place); });
}

NearFace TargetSurface::nearest(const Vec3& p, Index hint) {
  if (given_ == nullptr) {
    if (!made_) made_.emplace(mesh_);
    return made_->nearest(p, hint);
  }
  const SurfaceIndex::Hit hit = given_->nearest(p, std::numeric_limits<double>::infinity(), hint);
  return {hit.face, hit.distance};
}

}  // namespace lodestone::detail

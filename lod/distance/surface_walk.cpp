// Descends from face to face, as locating a point by walking does in a triangulation (see O. Devillers, S. Pion,
// M. Teillaud: Walking in a triangulation, 2002): here what falls is the distance, and the walk goes on over those
// faces alone that share what the nearest point lies on.

#include "distance/surface_walk.h"

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/detail/position_index.h>

namespace lodestone::detail {

SurfaceWalk::SurfaceWalk(const Mesh& mesh) : place_(mesh.corner_wedge.size()), across_(mesh.corner_wedge.size()) {
  const std::vector<Index> place_of_vertex = places_of(mesh.positions);
  const auto place_of = [&](Index corner) { return place_[corner]; };
  for (Index c = 0; c < place_.size(); ++c) place_[c] = place_of_vertex[mesh.corner_vertex(c)];
  corners_ = Grouping(mesh.vertex_count(), place_.size(), place_of);
  for_each_edge(sorted_edges(place_.size(), place_of), [&](Edge edge) {
    for (std::size_t i = 0; i < edge.size(); ++i) across_[edge[i].corner] = edge[(i + 1) % edge.size()].corner;
  });
  update(mesh);
}

void SurfaceWalk::update(const Mesh& mesh) {
  triangles_.resize(mesh.face_count());
  for (Index f = 0; f < triangles_.size(); ++f) triangles_[f] = triangle_of(mesh, f);
}

SurfaceWalk::Place SurfaceWalk::nearest_from(const Vec3& p, Index face) const {
  Place best = look_at(p, face);
  for (Index before = kNoIndex; best.face != before;) {
    before = best.face;
    try_around(p, best);
  }
  return best;
}

SurfaceWalk::Place SurfaceWalk::look_at(const Vec3& p, Index face) const {
  const NearestPoint nearest = nearest_in_triangle(p, triangles_[face]);
  return {face, nearest.point, nearest.corners, squared_length(p - nearest.point)};
}

void SurfaceWalk::try_face(const Vec3& p, Index face, Place& best) const {
  if (face == best.face || is_no_nearer(triangles_[face], best.point, p)) return;
  const Place there = look_at(p, face);
  if (there.squared_distance < best.squared_distance) best = there;
}

/// Tries the faces beyond the edge that leaves a corner.
void SurfaceWalk::try_across(const Vec3& p, Index corner, Place& best) const {
  for (Index other = across_[corner]; other != corner; other = across_[other]) try_face(p, face_of_corner(other), best);
}

/// Tries the faces that share what the best point lies on, an edge or a corner; where it lies inside of a face, those
/// beyond its edges, which may be nearer in a fold.
void SurfaceWalk::try_around(const Vec3& p, Place& best) const {
  const Index first = 3 * best.face;
  switch (best.corners) {
    case 0b001:
    case 0b010:
    case 0b100:
      for (const Index corner : corners_[place_[first + best.corners / 2]]) try_face(p, face_of_corner(corner), best);
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

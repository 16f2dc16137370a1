#pragma once

#include <span>
#include <vector>

#include <lodestone/core/detail/grouping.h>
#include <lodestone/core/mesh.h>

#include "distance/triangle.h"

namespace lodestone::detail {

/// A surface to walk on, for points that are known to lie near one of its faces.
///
/// Faces that meet at an edge or a corner are neighbours, by position: sheets that were cut apart are whole here.
class SurfaceWalk {
 public:
  explicit SurfaceWalk(const Mesh& mesh);

  /// Takes the positions anew: vertices may have moved meanwhile, faces are the same.
  void update(const Mesh& mesh);

  /// Where a walk has ended.
  struct Place {
    Index face = kNoIndex;
    Vec3 point;
    unsigned corners = 0;  ///< of the face, between which the point lies: bit k stands for corner k
    double squared_distance = 0;
  };
  /// Returns a point of the surface to which none of the faces around it has a nearer one, coming from `face`: a local
  /// minimum of the distance, nearly always the nearest point of all where `face` lies near `p`.
  Place nearest_from(const Vec3& p, Index face) const;

 private:
  Place look_at(const Vec3& p, Index face) const;
  void try_face(const Vec3& p, Index face, Place& best) const;
  void try_across(const Vec3& p, Index corner, Place& best) const;
  void try_around(const Vec3& p, Place& best) const;

  std::vector<Triangle> triangles_;
  std::vector<Index> place_;   // by corner: the first vertex at its position
  Grouping corners_;           // by place
  std::vector<Index> across_;  // by the corner that an edge leaves: the next one at the same edge, in a circle
};

}  // namespace lodestone::detail

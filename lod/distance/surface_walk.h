#pragma once

#include <array>
#include <vector>

#include <lodestone/core/mesh.h>

#include "distance/triangle.h"

namespace lodestone::detail {

/// A surface to walk on, for points that are known to lie near one of its faces.
///
/// Faces that meet at an edge or a corner are neighbours, by position: sheets that were cut apart are whole here.
/// Distances are as fine as single precision is over the size of a face and the way from it.
class SurfaceWalk {
 public:
  /// The mesh outlives the object. Cost: O(n).
  explicit SurfaceWalk(const Mesh& mesh);

  /// To be called before the next walk once vertices have moved; faces are the same, and `mesh` outlives the object.
  void update(const Mesh& mesh);

  /// Where a walk has ended.
  struct Place {
    Index face = kNoIndex;
    Barycentric on;  ///< the point of the face
  };
  /// Returns a point of the surface to which none of the faces around it has a nearer one, coming from `face`: a local
  /// minimum of the distance, nearly always the nearest point of all where `face` lies near `p`.
  Place nearest_from(const Vec3& p, Index face) const;

  /// Returns a face's normal, of length 1; 0 where it has none.
  Vec3 normal(Index face) const {
    const Slab& slab = slabs_[face];
    return {slab.x[3], slab.y[3], slab.z[3]};
  }

 private:
  /// What says whether a point lies over the inside of a face, and beyond which edge if not. Edge k leaves corner k;
  /// the entries are for the three edges, and for the plane. What folds there is 0 at a border, and not a number where
  /// several faces lie beyond.
  struct alignas(16) Slab {
    std::array<float, 4> x, y, z;         // Directions: from each edge into the face, and the normal; of length 1.
    std::array<float, 4> offset;          // What to add to the products with a point, to have distances.
    std::array<float, 4> rise;            // How high the corner beyond each edge lies over the plane,
    std::array<float, 4> run;             // and how far from the edge.
    std::array<float, 4> inverse_height;  // Of the face, from each edge to the corner on the other side.

    bool has_area() const { return inverse_height[0] > 0; }  // Without, it says nothing.

    /// Where points are counted from, the first corner: it lies in the lanes of the plane which say nothing.
    Vec3f origin() const { return {rise[3], run[3], inverse_height[3]}; }
    void set_origin(const Vec3f& p) { rise[3] = p.x, run[3] = p.y, inverse_height[3] = p.z; }
  };

  /// How a point lies to a slab, in lanes like its own.
  struct alignas(16) Lie {
    std::array<float, 4> distance;  // From the edges, inwards, and from the plane.
    std::array<float, 4> slack;     // Below 0 where the face beyond folds up so far that the point lies before it.
    static Lie of(const Vec3& p, const Slab& slab);
  };

  /// A point of a triangle near to another point.
  struct Candidate {
    Index face = kNoIndex;
    Vec3 point;
    unsigned corners = 0;  // Between which the point lies: bit k stands for corner k.
    double squared_distance = 0;
  };

  Slab slab_of(Index face) const;
  void add_neighbours(Index face);
  bool has_one_across(Index corner) const { return across_[corner] != corner && across_[across_[corner]] == corner; }
  bool walk_over(const Vec3& p, Index& face, Place& place) const;
  bool look_into_folds(const Vec3& p, Index face, const Lie& lie, Index& nearer) const;
  bool land_on_edge(const Vec3& p, Index corner, float least, Place& place) const;
  Candidate look_at(const Vec3& p, Index face) const;
  void try_face(const Vec3& p, Index face, Candidate& best) const;
  void try_across(const Vec3& p, Index corner, Candidate& best) const;
  void try_at_corner(const Vec3& p, Index corner, Candidate& best) const;
  void try_around(const Vec3& p, Candidate& best) const;

  const Mesh* mesh_;
  std::vector<Slab> slabs_;
  std::vector<Index> around_;  // by corner: the next one at the same position, ascending, in a circle
  std::vector<Index> across_;  // by the corner that an edge leaves: the next one at the same edge, likewise
};

}  // namespace lodestone::detail

#pragma once

#include <memory>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone {

/// A surface prepared for nearest-point queries: a bounding-volume hierarchy over the faces of a mesh.
class SurfaceIndex {
 public:
  /// Copies what it needs from `mesh`. Cost: O(n log n).
  explicit SurfaceIndex(const Mesh& mesh);
  ~SurfaceIndex();
  SurfaceIndex(SurfaceIndex&&) noexcept;
  SurfaceIndex& operator=(SurfaceIndex&&) noexcept;

  /// What a search found, and what it cost.
  struct Hit {
    double distance = 0;    ///< mesh units; infinity where the mesh has no faces or all lie farther than the limit
    Vec3 point;             ///< the nearest point of the surface
    Index face = kNoIndex;  ///< the face it lies on
    Index visits = 0;       ///< nodes opened and faces looked at on the way: what the query cost
  };
  /// Returns the surface's nearest point to `p` among those no farther than `limit`; `hint` is a face likely near it.
  Hit nearest(const Vec3& p, double limit, Index hint = kNoIndex) const;

  /// The same for many points, without a limit, in less time where those that follow each other lie together: the face
  /// of each hit is its hint on entry, where it has one. Pre: as many hits as points. Visits are not counted.
  void nearest(std::span<const Vec3> points, std::span<Hit> hits) const;

  /// Sets `faces` to all that are no farther than `distance` from `p`, in ascending order.
  void within(const Vec3& p, double distance, std::vector<Index>& faces) const;

  /// Returns the distance from `p` to one face; pre: `face` is one of the mesh's.
  double distance_to_face(const Vec3& p, Index face) const;

  /// Returns a number for each face: faces whose numbers follow each other mostly lie together.
  std::span<const Index> ranks() const;

  bool empty() const;

  struct Impl;  ///< opaque

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone

#pragma once

#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/surface_index.h>

namespace lodestone::detail {

/// Where sheets lie on one another, no face there is nearer than the others: what is compared at a place besides
/// distance is compared with all of them, and the one that differs least counts.
class CoincidentFaces {
 public:
  /// Both outlive it; `index` is that of `mesh`.
  CoincidentFaces(const Mesh& mesh, const SurfaceIndex& index);

  /// Returns the faces that are as near to a point as the nearest one found, that one alone where the mesh has no
  /// sheets on one another. The span lasts until the next call.
  std::span<const Index> as_near_as(const SurfaceIndex::Hit& hit);

 private:
  const SurfaceIndex& index_;
  double tolerance_ = 0;  // mesh units; 0 without such sheets
  std::vector<Index> faces_;
};

}  // namespace lodestone::detail

#include "distance/coincident_faces.h"

#include <lodestone/core/detail/position_index.h>

namespace lodestone::detail {
namespace {

constexpr double kSheetTolerance = 1e-6;  // of the diagonal: sheets part by the rounding of decoded positions, no more

/// Whether vertices are copies of one another: a mesh without has no sheets that lie on one another.
bool has_copies(const Mesh& mesh) {
  const std::vector<Index> places = places_of(mesh.positions);
  for (Index v = 0; v < places.size(); ++v)
    if (places[v] != v) return true;
  return false;
}

}  // namespace

CoincidentFaces::CoincidentFaces(const Mesh& mesh, const SurfaceIndex& index) : index_(index) {
  if (has_copies(mesh)) tolerance_ = kSheetTolerance * bounding_box(mesh).diagonal();
}

std::span<const Index> CoincidentFaces::as_near_as(const SurfaceIndex::Hit& hit) {
  if (tolerance_ > 0) {
    index_.within(hit.point, tolerance_, faces_);
  } else {
    faces_.assign(1, hit.face);
  }
  return faces_;
}

}  // namespace lodestone::detail

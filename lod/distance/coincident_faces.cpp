#include "distance/coincident_faces.h"

#include <algorithm>
#include <array>

namespace lodestone::detail {
namespace {

constexpr double kTolerance = 1e-6;  // of the diagonal: sheets part by the rounding of decoded positions, no more

/// Whether vertices are copies of one another: a mesh without has no sheets that lie on one another.
bool has_copies(const Mesh& mesh) {
  std::vector<std::array<float, 3>> places;
  for (const Vec3f& p : mesh.positions) places.push_back({p.x, p.y, p.z});
  std::sort(places.begin(), places.end());
  return std::adjacent_find(places.begin(), places.end()) != places.end();
}

}  // namespace

CoincidentFaces::CoincidentFaces(const Mesh& mesh, const SurfaceIndex& index) : index_(index) {
  if (has_copies(mesh)) tolerance_ = kTolerance * bounding_box(mesh).diagonal();
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

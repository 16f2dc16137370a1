#include "simplify/carried_points.h"

namespace lodestone::detail {

CarriedPoints::CarriedPoints(const Mesh& mesh) : first_(mesh.face_count(), kNoIndex) {
  points_.reserve(mesh.vertex_count() + mesh.face_count());
  for (const Vec3f& position : mesh.positions) points_.push_back({position});
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Vec3 sum = mesh.corner_position(3 * f) + mesh.corner_position(3 * f + 1) + mesh.corner_position(3 * f + 2);
    points_.push_back({to_float(sum * (1.0 / 3))});
    add(f, static_cast<Index>(points_.size() - 1));
  }
}

}  // namespace lodestone::detail

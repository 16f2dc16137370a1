#include "simplify/carried_points.h"

namespace lodestone::detail {

CarriedPoints::CarriedPoints(const Mesh& mesh) : mesh_(&mesh), vertex_count_(static_cast<Index>(mesh.vertex_count())) {
  first_.assign(mesh.face_count(), kNoIndex);
  next_.assign(mesh.vertex_count() + mesh.face_count(), kNoIndex);
  weight_.assign(next_.size(), 1.0F);
  squared_distance_.assign(next_.size(), 0.0F);
  centroids_.reserve(mesh.face_count());
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Vec3 sum = mesh.corner_position(3 * f) + mesh.corner_position(3 * f + 1) + mesh.corner_position(3 * f + 2);
    const Vec3 c = sum * (1.0 / 3);
    centroids_.push_back({static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)});
    add(f, vertex_count_ + f);
  }
}

}  // namespace lodestone::detail

#include "stream/mesh_mark.h"

namespace lodestone::detail {

void MeshMark::restore(ProgressiveMesh& mesh) const {
  if (!begun_) {
    mesh = {};
    return;
  }
  const std::size_t wedges = mesh.record_wedge_begin[position_], sectors = mesh.sector_begin[position_];
  const std::uint64_t corners = mesh.polygon_begin[sectors], slots = mesh.slot_begin(sectors);
  mesh.positions.resize(mesh.base_vertex_count + position_);
  mesh.wedge_vertex.resize(wedges);
  for (Attribute& attribute : mesh.attributes) attribute.data.resize(wedges * attribute.element_bytes());
  for (std::size_t g = 0; g < face_counts_.size(); ++g) mesh.groups[g].face_count = face_counts_[g];
  mesh.record_wedge_begin.resize(position_ + 1);
  mesh.sector_begin.resize(position_ + 1);
  mesh.sectors.resize(sectors);
  mesh.polygon_begin.resize(sectors + 1);
  mesh.polygons.resize(corners);
  mesh.slots.resize(slots);
  mesh.triangles.resize(3 * slots);
  mesh.round_begin.resize(round_count_);
  mesh.deviation.resize(position_ + 1);
  mesh.curvature_error.resize(position_ + 1);
}

}  // namespace lodestone::detail

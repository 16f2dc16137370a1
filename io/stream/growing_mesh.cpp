#include "stream/growing_mesh.h"

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

/// Calls `visit` with each array of a mesh that has so many of something.
template <class Mesh, class Visit>
void for_each_array(Mesh& mesh, const Visit& visit) {
  visit(mesh.positions);
  visit(mesh.wedge_vertex);
  for (auto& attribute : mesh.attributes) visit(attribute.data);
  for (auto& group : mesh.groups) visit(group.base_corners);
  visit(mesh.record_wedge_begin);
  visit(mesh.sector_begin);
  visit(mesh.sectors);
  visit(mesh.polygon_begin);
  visit(mesh.polygons);
  visit(mesh.slots);
  visit(mesh.triangles);
  visit(mesh.move_begin);
  visit(mesh.moves);
  visit(mesh.round_begin);
  visit(mesh.deviation);
  visit(mesh.curvature_error);
}

}  // namespace

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
  if (!mesh.move_begin.empty()) {
    mesh.move_begin.resize(position_ + 1);
    mesh.moves.resize(mesh.move_begin.back());
  }
  mesh.round_begin.resize(round_count_);
  mesh.deviation.resize(position_ + 1);
  mesh.curvature_error.resize(position_ + 1);
}

std::uint64_t held_bytes(const ProgressiveMesh& mesh) {
  std::uint64_t bytes = 0;
  for_each_array(mesh, [&](const auto& array) { bytes += std::uint64_t{array.capacity()} * sizeof(array[0]); });
  return bytes;
}

Result<void> check_held_bytes(const ProgressiveMesh& mesh, std::uint64_t most) {
  return check_held_bytes(most == kNoLimit ? 0 : held_bytes(mesh), most);
}

Result<void> check_held_bytes(std::uint64_t held, std::uint64_t most) {
  if (held <= most) return {};
  return fail(ErrorCode::LimitExceeded, text("mesh takes ", held, " bytes, where it may take ", most));
}

void trim(ProgressiveMesh& mesh) {
  for_each_array(mesh, [](auto& array) { array.shrink_to_fit(); });
}

}  // namespace lodestone::detail

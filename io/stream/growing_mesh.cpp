#include "stream/growing_mesh.h"

#include <algorithm>
#include <utility>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

/// Calls `visit` with each array of a mesh that has so many of something, and with the same one of others beside it.
template <class Visit, class Mesh, class... Others>
void for_each_array(const Visit& visit, Mesh& mesh, Others&... others) {
  visit(mesh.positions, others.positions...);
  visit(mesh.wedge_vertex, others.wedge_vertex...);
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) visit(mesh.attributes[i].data, others.attributes[i].data...);
  for (std::size_t i = 0; i < mesh.groups.size(); ++i)
    visit(mesh.groups[i].base_corners, others.groups[i].base_corners...);
  visit(mesh.record_wedge_begin, others.record_wedge_begin...);
  visit(mesh.sector_begin, others.sector_begin...);
  visit(mesh.sectors, others.sectors...);
  visit(mesh.polygon_begin, others.polygon_begin...);
  visit(mesh.polygons, others.polygons...);
  visit(mesh.slots, others.slots...);
  visit(mesh.triangles, others.triangles...);
  visit(mesh.move_begin, others.move_begin...);
  visit(mesh.moves, others.moves...);
  visit(mesh.round_begin, others.round_begin...);
  visit(mesh.deviation, others.deviation...);
  visit(mesh.curvature_error, others.curvature_error...);
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

void MeshCopy::prepare(const ProgressiveMesh& mesh, const ProgressiveMesh& copy) {
  if (copy.groups.empty()) {  // nothing yet
    made_ = mesh;
    return;
  }
  made_ = {};
  made_.attributes.resize(mesh.attributes.size());
  made_.groups.resize(mesh.groups.size());
  const auto make_room = [](const auto& from, const auto& to, auto& made) {
    if (to.capacity() >= from.size()) return;
    made.reserve(std::max(from.size(), to.capacity() + to.capacity() / 2));
    made.assign(from.begin(), from.end());
  };
  for_each_array(make_room, mesh, copy, made_);
}

void MeshCopy::finish(const ProgressiveMesh& mesh, ProgressiveMesh& copy) {
  if (copy.groups.empty()) {
    std::swap(copy, made_);
    return;
  }
  const auto grow = [](const auto& from, auto& to, auto& made) {
    if (to.capacity() < from.size())
      to.swap(made);
    else
      to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(to.size()), from.end());
  };
  for_each_array(grow, mesh, copy, made_);
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) copy.groups[g].face_count = mesh.groups[g].face_count;
}

std::uint64_t held_bytes(const ProgressiveMesh& mesh) {
  std::uint64_t bytes = 0;
  for_each_array([&](const auto& array) { bytes += std::uint64_t{array.capacity()} * sizeof(array[0]); }, mesh);
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
  for_each_array([](auto& array) { array.shrink_to_fit(); }, mesh);
}

}  // namespace lodestone::detail

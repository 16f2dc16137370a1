#include <lodestone/io/draw_cursor.h>

#include <algorithm>

#include "runtime/vertex_moves.h"

namespace lodestone {

DrawCursor::DrawCursor(const ProgressiveMesh& mesh)
    : mesh_(&mesh),
      cursor_(mesh),
      changed_(mesh.groups.size(), detail::ChangedEntries(3)),
      moved_(1),
      face_counts_(mesh.groups.size()),
      wedges_reached_(cursor_.wedge_count()) {
  make_room();
  for (std::size_t g = 0; g < changed_.size(); ++g) changed_[g].mark(0, corners(g).size() / 3);
}

void DrawCursor::make_room() {
  for (std::size_t g = 0; g < changed_.size(); ++g) changed_[g].make_room(mesh_->groups[g].face_count);
  if (mesh_->move_begin.empty()) return;
  moved_.make_room(mesh_->wedge_vertex.size());
  detail::add_created(*mesh_, positions_);
}

/// Marks the slots that records overwrite, whichever way.
void DrawCursor::mark_records(Index first, Index end) {
  const Index first_sector = mesh_->sector_begin[first], end_sector = mesh_->sector_begin[end];
  for (Index s = first_sector; s < end_sector; ++s) {
    detail::ChangedEntries& changes = changed_[mesh_->sectors[s].group];
    for (std::uint64_t i = mesh_->slot_begin(s); i < mesh_->slot_begin(s + 1); ++i) changes.mark(mesh_->slots[i]);
  }
}

void DrawCursor::place(Index vertex, const Vec3f& position) {
  positions_[vertex] = position;
  const EntryRange wedges = detail::wedges_of(*mesh_, vertex);
  for (std::size_t wedge = wedges.begin; wedge < wedges.end; ++wedge) moved_.mark(wedge);
}

/// Moves vertices as the records passed do.
void DrawCursor::move_vertices(Index from, Index to) {
  if (mesh_->move_begin.empty()) return;
  detail::follow_moves(*mesh_, from, to, [this](Index vertex, const Vec3f& position) { place(vertex, position); });
}

void DrawCursor::seek(Index position) {
  make_room();
  const Index from = cursor_.position();
  for (std::size_t g = 0; g < changed_.size(); ++g) face_counts_[g] = corners(g).size() / 3;
  cursor_.seek(position);
  move_vertices(from, cursor_.position());
  mark_records(std::min(from, cursor_.position()), std::max(from, cursor_.position()));
  for (std::size_t g = 0; g < changed_.size(); ++g) changed_[g].mark(face_counts_[g], corners(g).size() / 3);
  wedges_reached_ = std::max(wedges_reached_, wedge_count());
}

void DrawCursor::take_changes(std::size_t group, std::size_t gap, std::vector<EntryRange>& ranges) {
  changed_[group].take(corners(group).size() / 3, gap, ranges);
}

EntryRange DrawCursor::take_new_wedges() {
  const EntryRange taken = {wedges_taken_, wedges_reached_};
  wedges_taken_ = wedges_reached_;
  return taken;
}

void DrawCursor::take_moved_wedges(std::size_t gap, std::vector<EntryRange>& ranges) {
  moved_.take(std::min(wedges_reached_, mesh_->wedge_vertex.size()), gap, ranges);
}

void copy_positions(const ProgressiveMesh& mesh, const DrawCursor& cursor, EntryRange wedges, float* out) {
  for (std::size_t w = wedges.begin; w < wedges.end; ++w) {
    const Vec3f& p = cursor.position(mesh.wedge_vertex[w]);
    *out++ = p.x, *out++ = p.y, *out++ = p.z;
  }
}

void copy_normals(const ProgressiveMesh& mesh, const DrawCursor& cursor, float* out) {
  std::vector<Vec3> sums(cursor.vertex_count());
  for (std::size_t group = 0; group < cursor.group_count(); ++group) {
    const std::span<const Index> corners = cursor.corners(group);
    for (std::size_t c = 0; c < corners.size(); c += 3) {
      const Index v[3] = {mesh.wedge_vertex[corners[c]], mesh.wedge_vertex[corners[c + 1]],
                          mesh.wedge_vertex[corners[c + 2]]};
      const Vec3 origin(cursor.position(v[0]));
      const Vec3 area = cross(Vec3(cursor.position(v[1])) - origin, Vec3(cursor.position(v[2])) - origin);
      for (const Index vertex : v) sums[vertex] += area;
    }
  }
  for (std::size_t w = 0; w < cursor.wedge_count(); ++w) {
    const Vec3f normal = to_float(normalized(sums[mesh.wedge_vertex[w]]));
    *out++ = normal.x, *out++ = normal.y, *out++ = normal.z;
  }
}

}  // namespace lodestone

#include <lodestone/io/draw_cursor.h>

#include <algorithm>
#include <bit>

namespace lodestone {

void DrawCursor::Changes::make_room(std::size_t item_count) {
  const std::size_t blocks = (item_count + kBlock - 1) / kBlock, words = (blocks + 63) / 64;
  if (words > bits_.size()) bits_.resize(words, 0);
}

void DrawCursor::Changes::mark(std::size_t first, std::size_t end) {
  for (std::size_t item = first; item < end; item = (item / kBlock + 1) * kBlock) mark(item);
}

/// Those of items that are no more count for nothing: they are marked again where they come back.
void DrawCursor::Changes::take(std::size_t item_count, std::size_t gap, std::vector<EntryRange>& ranges) {
  ranges.clear();
  for (std::size_t word = 0; word < bits_.size(); ++word)
    for (std::uint64_t bits = bits_[word]; bits != 0; bits &= bits - 1) {
      const std::size_t block = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      const EntryRange changed = {entries_each_ * kBlock * block,
                                  entries_each_ * std::min(kBlock * (block + 1), item_count)};
      if (changed.begin >= changed.end) continue;
      if (!ranges.empty() && changed.begin - ranges.back().end <= gap)
        ranges.back().end = changed.end;
      else
        ranges.push_back(changed);
    }
  std::fill(bits_.begin(), bits_.end(), 0);
}

DrawCursor::DrawCursor(const ProgressiveMesh& mesh)
    : mesh_(&mesh),
      cursor_(mesh),
      changed_(mesh.groups.size(), Changes(3)),
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
  // What has come since lies where it is created.
  positions_.insert(positions_.end(), mesh_->positions.begin() + static_cast<std::ptrdiff_t>(positions_.size()),
                    mesh_->positions.end());
}

/// Marks the slots that records overwrite, whichever way.
void DrawCursor::mark_records(Index first, Index end) {
  const Index first_sector = mesh_->sector_begin[first], end_sector = mesh_->sector_begin[end];
  for (Index s = first_sector; s < end_sector; ++s) {
    Changes& changes = changed_[mesh_->sectors[s].group];
    for (std::uint64_t i = mesh_->slot_begin(s); i < mesh_->slot_begin(s + 1); ++i) changes.mark(mesh_->slots[i]);
  }
}

void DrawCursor::place(Index vertex, const Vec3f& position) {
  positions_[vertex] = position;
  const std::vector<Index>& vertices = mesh_->wedge_vertex;
  std::size_t wedge = 0;
  if (vertex >= mesh_->base_vertex_count) {
    wedge = mesh_->record_wedge_begin[vertex - mesh_->base_vertex_count];
  } else {
    const auto end = vertices.begin() + mesh_->base_wedge_count;
    wedge = static_cast<std::size_t>(std::lower_bound(vertices.begin(), end, vertex) - vertices.begin());
  }
  for (; wedge < vertices.size() && vertices[wedge] == vertex; ++wedge) moved_.mark(wedge);
}

/// Moves vertices as the records passed do.
void DrawCursor::move_vertices(Index from, Index to) {
  if (mesh_->move_begin.empty()) return;
  const std::span<const VertexMove> moves(mesh_->moves);
  const Index begin = mesh_->move_begin[std::min(from, to)], end = mesh_->move_begin[std::max(from, to)];
  for (Index i = begin; from < to && i < end; ++i) place(moves[i].vertex, moves[i].to);
  for (Index i = end; from > to && i-- > begin;) place(moves[i].vertex, moves[i].from);
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

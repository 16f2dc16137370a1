#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/io/entry_range.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// A cursor that says what an engine has to upload after each move: which entries of the index buffers changed, which
/// wedges are new, and which lie elsewhere. Vertex buffers only grow, and a coarser level uses the first of what is in
/// them.
///
/// Allocates when it is made, and after that only where the mesh has grown.
class DrawCursor {
 public:
  /// Starts at the base mesh, all of which has to be uploaded. Pre: as for Cursor.
  explicit DrawCursor(const ProgressiveMesh& mesh);

  Index position() const { return cursor_.position(); }

  /// Moves to `position`, clamped to record_count(). Cost: proportional to the records passed.
  void seek(Index position);

  std::size_t group_count() const { return changed_.size(); }
  std::size_t vertex_count() const { return cursor_.vertex_count(); }
  std::size_t wedge_count() const { return cursor_.wedge_count(); }
  std::size_t face_count() const { return cursor_.face_count(); }
  /// The level's faces of one group: three wedges each.
  std::span<const Index> corners(std::size_t group) const { return cursor_.corners(group); }

  /// Gives the ranges of a group's corners that may have changed since they were taken last, ascending, none empty:
  /// those within `gap` entries of each other as one, since a call costs as much as some bytes do. What is not in them
  /// is what it was then. Pre: `ranges` holds what is taken of it; allocates like a vector.
  void take_changes(std::size_t group, std::size_t gap, std::vector<EntryRange>& ranges);
  /// Gives the wedges that levels since have had and none before: their positions and attributes are to be uploaded.
  EntryRange take_new_wedges();
  /// Gives the ranges of wedges whose positions may have changed since they were taken last, those that were new in
  /// between besides; as `take_changes`.
  void take_moved_wedges(std::size_t gap, std::vector<EntryRange>& ranges);

  /// Where a vertex of the mesh lies; one that the level does not have, where it will when that comes back.
  const Vec3f& position(Index vertex) const {
    return vertex < positions_.size() ? positions_[vertex] : mesh_->positions[vertex];
  }

 private:
  void make_room();
  void mark_records(Index first, Index end);
  void move_vertices(Index from, Index to);
  void place(Index vertex, const Vec3f& position);

  const ProgressiveMesh* mesh_;
  Cursor cursor_;
  std::vector<detail::ChangedEntries> changed_;  // faces, by group
  detail::ChangedEntries moved_;                 // wedges
  std::vector<Vec3f> positions_;          // of the vertices that were there at the last move, where records move any
  std::vector<std::size_t> face_counts_;  // by group, where a move began
  std::size_t wedges_reached_;
  std::size_t wedges_taken_ = 0;
};

/// Copies the positions that wedges have at a cursor to `out`, three floats each. Pre: they lie in the mesh, and there
/// is room for them.
void copy_positions(const ProgressiveMesh& mesh, const DrawCursor& cursor, EntryRange wedges, float* out);

/// Writes smooth normals for the wedges of the cursor's level, three floats each: the mean of the faces around the
/// vertex by their areas, of length 1 or, where there are none, 0. Pre: there is room for them. Cost: the level's faces
/// and wedges; allocates for the vertices.
void copy_normals(const ProgressiveMesh& mesh, const DrawCursor& cursor, float* out);

}  // namespace lodestone

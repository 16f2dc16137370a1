#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/io/entry_range.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// The way between a coarse level and a finer one, on which vertices slide and nothing pops.
///
/// It is drawn with the index buffers of the fine level. At its beginning every wedge has the position and the
/// attributes of one of the coarse level, its *origin*: a wedge that the coarse level has, its own as they are there; a
/// new one, those of a corner of the patch that its vertex came into, and where that corner is new itself, those of its
/// origin. At its end every wedge has its own. In between an engine mixes the two, t = 0 … 1; the other way round it
/// coarsens, and goes over to the coarse level's index buffers when it is there.
///
/// *What is seen at t = 0.* All corners of faces are vertices of the coarse level, and a vertex has one place, whatever
/// its wedges, so that seams are closed at every t. A record's faces are then those that it replaced, besides some
/// without area, where all of those meet in the corner that was chosen: always in patches of up to five corners inside
/// a surface. In others some edges lie differently: the corner is one that as many as can be meet in. Levels far apart
/// differ more, since that adds up, and faces fold over: go there in steps. Where a vertex joins sheets that no edge at
/// it joins, the patches of the others reach for its origin.
///
/// *Attributes* begin with those of the wedge on the same side of a seam. Whole numbers that are not normalized, as
/// joints, do not mix: they are the fine level's from the beginning, and so are their weights.
///
/// Allocates when it is made, and after that only where the mesh has grown. Hoppe's geomorphs have vertices slide out
/// of the one that was split, and so are exact throughout; removals are filled by any triangles, so that not all are.
class Geomorph {
 public:
  /// Begins and ends at the base mesh. Pre: as for Cursor.
  explicit Geomorph(const ProgressiveMesh& mesh);

  /// Names the two levels, clamped to record_count(). Pre: coarse ≤ fine. Cost: the records between them, and the moves
  /// of those between this coarse level and the last.
  void set(Index coarse, Index fine);

  Index coarse() const { return coarse_; }
  Index fine() const { return fine_; }

  /// The wedges that the fine level has and the coarse one has not.
  EntryRange new_wedges() const { return {first_, first_ + origins_.size()}; }
  /// Gives the ranges of the others whose positions may differ between the levels that `set` has named since they were
  /// taken last, as DrawCursor's take_moved_wedges does.
  void take_moved_wedges(std::size_t gap, std::vector<EntryRange>& ranges);

  /// The wedge of the coarse level that one of the fine level begins as, itself where the coarse level has it. Of a
  /// piece that the coarse level has nothing of: one of the piece's first vertices, so that nothing is seen of that at
  /// t = 0. Pre: the fine level has the wedge.
  Index origin(Index wedge) const { return wedge < first_ ? wedge : origins_[wedge - first_]; }

  /// Where a wedge of the fine level begins.
  const Vec3f& start(Index wedge) const { return position(mesh_->wedge_vertex[origin(wedge)]); }

 private:
  void make_room();
  void place_coarse(Index position);
  void mark_moved();
  Index root(Index wedge);
  void find_origins(Index record);
  void join_piece(Index wedge, Index origin);
  const Vec3f& position(Index vertex) const {
    return vertex < positions_.size() ? positions_[vertex] : mesh_->positions[vertex];
  }

  const ProgressiveMesh* mesh_;
  Index coarse_ = 0;
  Index fine_ = 0;
  Index first_ = 0;               // the coarse level's wedges are those before
  std::vector<Index> origins_;    // of the others
  std::vector<Vec3f> positions_;  // of the coarse level, where records move vertices
  detail::ChangedEntries moved_;  // wedges
};

/// Copies where wedges of the fine level begin to `out`, three floats each. Pre: it has them, and there is room.
void copy_starts(const Geomorph& morph, EntryRange wedges, float* out);

/// Copies what an attribute of the mesh begins with at wedges of the fine level to `out`, element_bytes() each. Pre: as
/// for copy_starts.
void copy_starts(const Geomorph& morph, const Attribute& attribute, EntryRange wedges, std::byte* out);

}  // namespace lodestone

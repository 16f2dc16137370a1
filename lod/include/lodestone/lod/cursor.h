#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// A position in the removal stream, with the index buffers of its level.
///
/// Moves in both directions, one record at a time; allocates when it is made, and after that only where the mesh has
/// grown. The level at a position does not depend on the way there: its bytes are the same after any sequence of moves.
class Cursor {
 public:
  /// Starts at the base mesh. Pre: `mesh` is valid (see `validate`) and outlives the cursor. Records may be appended to
  /// it while the cursor stands anywhere: it is valid before and after, and what it had stays.
  explicit Cursor(const ProgressiveMesh& mesh);

  Index position() const { return position_; }

  /// Moves to `position`, clamped to record_count(). Cost: proportional to the records passed.
  void seek(Index position);
  /// Applies the next record; pre: position() < record_count(). Allocates like a vector where the mesh has grown.
  void refine();
  /// Undoes the last record; pre: position() > 0.
  void coarsen();

  std::size_t vertex_count() const { return mesh_->base_vertex_count + std::size_t{position_}; }
  std::size_t wedge_count() const { return mesh_->record_wedge_begin[position_]; }
  std::size_t face_count() const;
  /// The level's faces of one group: three wedges each.
  std::span<const Index> corners(std::size_t group) const { return corners_[group]; }

 private:
  void make_room();
  void fetch(std::size_t record) const;

  const ProgressiveMesh* mesh_;
  Index position_ = 0;
  std::vector<std::vector<Index>> corners_;
};

/// Returns the level at the cursor as a mesh of its own, with the wedges and vertices it uses.
Mesh extract_level(const ProgressiveMesh& mesh, const Cursor& cursor);

/// Returns the level at a position, clamped to record_count().
Mesh extract_level(const ProgressiveMesh& mesh, Index position);

}  // namespace lodestone

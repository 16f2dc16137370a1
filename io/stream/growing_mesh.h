#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone::detail {

/// How far a progressive mesh that grows has come: a chunk that turns out broken is taken away again.
class MeshMark {
 public:
  /// Pre: the mesh is whole, or has nothing yet.
  explicit MeshMark(const ProgressiveMesh& mesh) : position_(mesh.record_count()), begun_(!mesh.groups.empty()) {
    for (const FaceGroup& group : mesh.groups) face_counts_.push_back(group.face_count);
    round_count_ = mesh.round_begin.size();
  }

  /// Takes away what has been appended since. What was there then is as it was.
  void restore(ProgressiveMesh& mesh) const;

 private:
  std::size_t position_;
  std::size_t round_count_ = 0;
  bool begun_;
  std::vector<Index> face_counts_;
};

/// Has a copy of a mesh grow as that does, in two steps: the first takes the time and the memory, the second alone
/// changes the copy. Pre: what the mesh had when it was copied last is as it was.
class MeshCopy {
 public:
  /// Makes arrays where those of the copy have no room for what the mesh has now.
  void prepare(const ProgressiveMesh& mesh, const ProgressiveMesh& copy);
  /// Copies what is new, and puts those arrays in place; this keeps the ones before them. Allocates nothing.
  /// Pre: neither mesh has changed since `prepare`.
  void finish(const ProgressiveMesh& mesh, ProgressiveMesh& copy);

 private:
  ProgressiveMesh made_;  // empty arrays where there is room
};

/// Returns the bytes that a mesh's arrays take, with the room that they have to grow.
std::uint64_t held_bytes(const ProgressiveMesh& mesh);

inline constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

/// Checks that they are no more than `most`. Errors: LimitExceeded.
Result<void> check_held_bytes(const ProgressiveMesh& mesh, std::uint64_t most);
Result<void> check_held_bytes(std::uint64_t held, std::uint64_t most);

/// Gives back that room.
void trim(ProgressiveMesh& mesh);

}  // namespace lodestone::detail

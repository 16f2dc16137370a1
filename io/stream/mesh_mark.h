#pragma once

#include <cstddef>
#include <vector>

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

}  // namespace lodestone::detail

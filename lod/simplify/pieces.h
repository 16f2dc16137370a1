#pragma once

#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/detail/grouping.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// The pieces of a mesh: what hangs together over edges and over copies of vertices. Removals of vertices keep pieces
/// whole, so they are found once.
class Pieces {
 public:
  Pieces(const Mesh& mesh, const Connectivity& connectivity);

  std::size_t count() const { return face_count_.size(); }
  Index piece_of(Index vertex) const { return piece_[vertex]; }
  /// The full mesh's vertices of a piece.
  std::span<const Index> vertices(Index piece) const { return vertices_[piece]; }
  /// The faces a piece has left.
  std::size_t face_count(Index piece) const { return face_count_[piece]; }
  void lose_faces(Index piece, std::size_t count) { face_count_[piece] -= count; }
  std::size_t left() const { return left_; }
  void vanish(Index piece) {
    face_count_[piece] = 0;
    --left_;
  }

  /// What a piece that vanishes is charged for, a length that compares with the distance sums of removals: all of the
  /// points it stands for are lost, each as far as the piece is wide.
  /// Pre: it has lost no faces.
  double charge(const Mesh& mesh, Index piece) const;

 private:
  std::vector<Index> piece_;  // by vertex
  Grouping vertices_;
  std::vector<std::size_t> face_count_;
  std::size_t left_ = 0;
};

}  // namespace lodestone::detail

#include "simplify/pieces.h"

#include <algorithm>
#include <cmath>

#include <lodestone/core/union_find.h>

namespace lodestone::detail {

Pieces::Pieces(const Mesh& mesh, const Connectivity& connectivity) : piece_(mesh.vertex_count(), kNoIndex) {
  UnionFind joined(mesh.vertex_count());
  for (Index f = 0; f < mesh.face_count(); ++f) {
    joined.join(mesh.corner_vertex(3 * f), mesh.corner_vertex(3 * f + 1));
    joined.join(mesh.corner_vertex(3 * f), mesh.corner_vertex(3 * f + 2));
  }
  for (Index v = 0; v < mesh.vertex_count(); ++v) joined.join(v, connectivity.site(v));
  Index count = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) piece_[v] = joined.find(v) == v ? count++ : piece_[joined.find(v)];
  vertices_ = Grouping(count, piece_.size(), [&](Index v) { return piece_[v]; });
  face_count_.assign(count, 0);
  for (Index f = 0; f < mesh.face_count(); ++f) ++face_count_[piece_[mesh.corner_vertex(3 * f)]];
  for (const std::size_t faces : face_count_) left_ += faces > 0 ? 1 : 0;
}

double Pieces::charge(const Mesh& mesh, Index piece) const {
  const std::span<const Index> members = vertices(piece);
  Vec3 center;
  for (const Index v : members) center += Vec3(mesh.positions[v]);
  center = center * (1 / static_cast<double>(members.size()));
  double squares = 0;
  for (const Index v : members) squares += squared_length(Vec3(mesh.positions[v]) - center);
  const double width = 2 * std::sqrt(squares / static_cast<double>(members.size()));
  return width * std::sqrt(static_cast<double>(members.size() + face_count_[piece]));
}

}  // namespace lodestone::detail

#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/io/entry_range.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone::detail {

/// Returns the wedges of a vertex.
inline EntryRange wedges_of(const ProgressiveMesh& mesh, Index vertex) {
  if (vertex >= mesh.base_vertex_count) {
    const std::size_t record = vertex - mesh.base_vertex_count;
    return {mesh.record_wedge_begin[record], mesh.record_wedge_begin[record + 1]};
  }
  const auto begin = mesh.wedge_vertex.begin();
  const auto [first, last] = std::equal_range(begin, begin + mesh.base_wedge_count, vertex);
  return {static_cast<std::size_t>(first - begin), static_cast<std::size_t>(last - begin)};
}

/// Has vertices go where they lie at another position: calls `place` with each move's vertex and where that is then, in
/// the order of the way. Pre: the mesh has moves.
template <class Place>
void follow_moves(const ProgressiveMesh& mesh, Index from, Index to, const Place& place) {
  const std::span<const VertexMove> moves(mesh.moves);
  const Index begin = mesh.move_begin[std::min(from, to)], end = mesh.move_begin[std::max(from, to)];
  for (Index i = begin; from < to && i < end; ++i) place(moves[i].vertex, moves[i].to);
  for (Index i = end; from > to && i-- > begin;) place(moves[i].vertex, moves[i].from);
}

/// Lets positions of a mesh's vertices be as many as those, where the mesh has grown: what has come since lies where it
/// is created.
inline void add_created(const ProgressiveMesh& mesh, std::vector<Vec3f>& positions) {
  positions.insert(positions.end(), mesh.positions.begin() + static_cast<std::ptrdiff_t>(positions.size()),
                   mesh.positions.end());
}

}  // namespace lodestone::detail

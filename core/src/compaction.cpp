#include <lodestone/core/detail/compaction.h>

#include <utility>

namespace lodestone::detail {

Compaction in_old_order(std::size_t count, std::span<const Index> used) {
  std::vector<bool> is_used(count, false);
  for (const Index thing : used) is_used[thing] = true;
  Compaction compaction(count);
  for (Index thing = 0; thing < count; ++thing)
    if (is_used[thing]) compaction.add(thing);
  return compaction;
}

CompactedMesh compacted(std::span<const Vec3f> positions, std::span<const Index> wedge_vertex,
                        std::span<const Index> corner_wedge) {
  CompactedMesh result;
  Mesh& mesh = result.mesh;
  Compaction wedges(wedge_vertex.size()), vertices(positions.size());
  mesh.corner_wedge.reserve(corner_wedge.size());
  for (const Index wedge : corner_wedge) mesh.corner_wedge.push_back(wedges.add(wedge));
  mesh.wedge_vertex.reserve(wedges.used().size());
  for (const Index wedge : wedges.used()) mesh.wedge_vertex.push_back(vertices.add(wedge_vertex[wedge]));
  mesh.positions = pick_entries(positions, vertices.used());
  result.source_vertex = vertices.used();
  result.source_wedge = wedges.used();
  return result;
}

}  // namespace lodestone::detail

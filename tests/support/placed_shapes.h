#pragma once

#include <algorithm>
#include <vector>

#include <lodestone/lod/placed_level.h>
#include <lodestone/lod/progressive_mesh.h>

#include "support/random.h"

namespace lodestone::test {

/// Places levels of a mesh anywhere near where they are, up to `reach` (mesh units) away; their deviations are bounds.
inline std::vector<PlacedLevel> scattered_levels(const ProgressiveMesh& mesh, std::size_t count, double reach,
                                                 double precision, std::uint64_t seed) {
  Random random(seed);
  std::vector<PlacedLevel> levels;
  const std::size_t records = mesh.record_count();
  for (std::size_t i = 1; i <= count; ++i) {
    PlacedLevel level;
    level.position = static_cast<Index>(records * i / (count + 1));
    if (level.position <= (levels.empty() ? 0 : levels.back().position) || level.position >= records) continue;
    double farthest = 0;
    for (std::size_t v = 0; v < mesh.base_vertex_count + level.position; ++v) {
      const Vec3 off = Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()} * reach;
      level.positions.push_back(to_float(Vec3(mesh.positions[v]) + off));
      farthest = std::max(farthest, length(Vec3(level.positions.back()) - Vec3(mesh.positions[v])));
    }
    // Bounds of the mesh may be lower at coarser levels.
    const auto rest = mesh.deviation.begin() + level.position;
    level.deviation =
        static_cast<float>(1.000001 * (static_cast<double>(*std::max_element(rest, mesh.deviation.end())) + farthest));
    level.precision = static_cast<float>(precision);
    levels.push_back(std::move(level));
  }
  return levels;
}

/// Has records move vertices of their levels anywhere near.
inline void add_moves(ProgressiveMesh& mesh, double reach, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> positions = mesh.positions;
  mesh.moves.clear();
  mesh.move_begin.assign(1, 0);
  for (std::size_t record = 0; record < mesh.record_count(); ++record) {
    for (std::uint64_t i = random.below(4); i > 0 && mesh.base_vertex_count + record > 0; --i) {
      const auto vertex = static_cast<Index>(random.below(mesh.base_vertex_count + record));
      const Vec3 off = Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()} * reach;
      const Vec3f to = to_float(Vec3(positions[vertex]) + off);
      mesh.moves.push_back({vertex, positions[vertex], to});
      positions[vertex] = to;
    }
    mesh.move_begin.push_back(static_cast<Index>(mesh.moves.size()));
  }
}

}  // namespace lodestone::test

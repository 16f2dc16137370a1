#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/removal.h>

#include "support/random.h"

// Removals of any vertices, legal and ugly.

namespace lodestone::test {

/// Whether filling the polygon as a fan from its corner `apex` keeps the mesh simple.
inline bool fan_is_simple(const Connectivity& mesh, const SectorPatch& sector, std::size_t apex, Index vertex) {
  const std::size_t size = sector.polygon.size();
  std::set<Index> distinct;
  for (const Index wedge : sector.polygon) distinct.insert(mesh.vertex_of_wedge(wedge));
  if (distinct.size() != size || distinct.count(vertex) != 0) return false;
  for (std::size_t i = 0; i < size; ++i) {
    const bool is_neighbour = i == apex || (i + 1) % size == apex || (apex + 1) % size == i;
    if (!is_neighbour &&
        mesh.has_edge(mesh.vertex_of_wedge(sector.polygon[apex]), mesh.vertex_of_wedge(sector.polygon[i])))
      return false;
  }
  return true;
}

inline void fill_with_fan(SectorPatch& sector, std::size_t apex) {
  const auto size = sector.polygon.size();
  for (std::size_t i = 1; i + 1 < size; ++i) {
    std::array<std::size_t, 3> c{apex, (apex + i) % size, (apex + i + 1) % size};
    std::sort(c.begin(), c.end());
    sector.triangles.push_back(
        {static_cast<std::uint8_t>(c[0]), static_cast<std::uint8_t>(c[1]), static_cast<std::uint8_t>(c[2])});
  }
}

inline bool closing_edge_is_free(const Connectivity& mesh, const RemovalRecord& record) {
  const SectorPatch& first = record.sectors.front();
  const auto vertex = [&](const SectorPatch& s, std::size_t i) { return mesh.vertex_of_wedge(s.polygon[i]); };
  if (first.shape == SectorShape::Closed) {
    // A triangle must not be closed over an existing one.
    const Index outer = mesh.opposite(3 * first.faces[0] + first.rotation[0]);
    return first.polygon.size() > 3 || outer == kNoIndex || mesh.vertex(outer) != vertex(first, 2);
  }
  for (const SectorPatch& sector : record.sectors)
    if (sector.polygon.size() == 2) return false;
  return !mesh.has_edge(vertex(first, 0), vertex(first, first.polygon.size() - 1));
}

/// Describes the removal of `vertex` with fans, if it is legal; geometry plays no part here.
inline bool plan_removal(const Connectivity& mesh, Index vertex, Random& random, RemovalRecord& record) {
  Star star;
  mesh.gather_star(vertex, star);
  const VertexKind kind = mesh.kind(vertex, star);
  if (kind != VertexKind::Interior && kind != VertexKind::Border && kind != VertexKind::Feature) return false;
  if (star.corners.size() > 60) return false;
  record.vertex = vertex;
  describe_removal(mesh, star, record);
  if (!closing_edge_is_free(mesh, record)) return false;
  for (SectorPatch& sector : record.sectors) {
    const auto apex = random.below(sector.polygon.size());
    if (!fan_is_simple(mesh, sector, apex, vertex)) return false;
    fill_with_fan(sector, apex);
  }
  return true;
}

/// Removes a vertex picked at random, if one of so many picked can go; its record, or one of no vertex.
inline RemovalRecord remove_any(Connectivity& mesh, Random& random, int tries = 50) {
  for (; tries > 0; --tries) {
    const auto vertex = static_cast<Index>(random.below(mesh.vertex_count()));
    RemovalRecord record;
    if (!mesh.has_vertex(vertex) || !plan_removal(mesh, vertex, random, record)) continue;
    remove_vertex(mesh, record);
    return record;
  }
  return {};
}

}  // namespace lodestone::test

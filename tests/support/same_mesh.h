#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include <lodestone/lod/progressive_mesh.h>

namespace lodestone::test {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool same_groups(const ProgressiveMesh& a, const ProgressiveMesh& b) {
  return std::equal(
      a.groups.begin(), a.groups.end(), b.groups.begin(), b.groups.end(), [](const auto& x, const auto& y) {
        return x.material == y.material && x.face_count == y.face_count && x.base_corners == y.base_corners;
      });
}

inline bool same_attributes(const ProgressiveMesh& a, const ProgressiveMesh& b) {
  return std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(), b.attributes.end(),
                    [](const Attribute& x, const Attribute& y) {
                      return x.name == y.name && x.type == y.type && x.component_count == y.component_count &&
                             x.normalized == y.normalized && x.data == y.data;
                    });
}

inline bool same_sectors(const ProgressiveMesh& a, const ProgressiveMesh& b) {
  return std::equal(a.sectors.begin(), a.sectors.end(), b.sectors.begin(), b.sectors.end(),
                    [](const SectorHeader& x, const SectorHeader& y) {
                      return x.polygon_size == y.polygon_size && x.group == y.group && x.wedge == y.wedge &&
                             x.shape == y.shape;
                    });
}

/// Returns whether two progressive meshes are the same, byte for byte.
inline bool same(const ProgressiveMesh& a, const ProgressiveMesh& b) {
  return same_bytes(a.positions, b.positions) && a.wedge_vertex == b.wedge_vertex && same_attributes(a, b) &&
         same_groups(a, b) && a.base_vertex_count == b.base_vertex_count && a.base_wedge_count == b.base_wedge_count &&
         a.record_wedge_begin == b.record_wedge_begin && a.sector_begin == b.sector_begin && same_sectors(a, b) &&
         a.polygon_begin == b.polygon_begin && a.polygons == b.polygons && a.slots == b.slots &&
         a.triangles == b.triangles && a.move_begin == b.move_begin && same_bytes(a.moves, b.moves) &&
         a.round_begin == b.round_begin && same_bytes(a.deviation, b.deviation) &&
         same_bytes(a.curvature_error, b.curvature_error);
}

}  // namespace lodestone::test

#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>

#include "support/catch.h"
#include "support/shapes.h"

namespace lodestone::test {

/// Returns a soup's mesh; the shapes always have one.
inline Mesh mesh_of(const TriangleSoup& soup) {
  auto assembled = assemble(soup);
  REQUIRE(assembled);
  return std::move(assembled->mesh);
}

/// One corner of a face: its position's bytes and its attributes'.
using CornerBytes = std::vector<std::byte>;
using FaceBytes = std::array<CornerBytes, 3>;

inline CornerBytes corner_bytes(const Mesh& mesh, Index corner) {
  const Index wedge = mesh.corner_wedge[corner];
  CornerBytes bytes(sizeof(Vec3f));
  std::memcpy(bytes.data(), &mesh.positions[mesh.wedge_vertex[wedge]], sizeof(Vec3f));
  for (const Attribute& attribute : mesh.attributes) {
    const auto begin = attribute.data.begin() + static_cast<std::ptrdiff_t>(wedge * attribute.element_bytes());
    bytes.insert(bytes.end(), begin, begin + static_cast<std::ptrdiff_t>(attribute.element_bytes()));
  }
  return bytes;
}

/// Returns a mesh's triangles as a set of bytes: positions, attributes and materials, whatever their order and rotation.
inline std::multiset<std::pair<Index, FaceBytes>> triangle_set(const Mesh& mesh) {
  std::multiset<std::pair<Index, FaceBytes>> triangles;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    FaceBytes face{corner_bytes(mesh, 3 * f), corner_bytes(mesh, 3 * f + 1), corner_bytes(mesh, 3 * f + 2)};
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    triangles.emplace(mesh.material_of(f), std::move(face));
  }
  return triangles;
}

/// Returns V − E + F of the faces that are left.
inline int euler_characteristic(const Connectivity& mesh) {
  int vertices = 0;
  int half_edges = 0;
  int border_edges = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v) vertices += mesh.has_vertex(v) ? 1 : 0;
  for (Index c = 0; c < 3 * mesh.face_slot_count(); ++c) {
    if (!mesh.has_face(face_of_corner(c))) continue;
    ++half_edges;
    border_edges += mesh.opposite(c) == kNoIndex ? 1 : 0;
  }
  return vertices - (half_edges + border_edges) / 2 + static_cast<int>(mesh.face_count());
}

}  // namespace lodestone::test

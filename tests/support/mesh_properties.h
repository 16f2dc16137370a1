#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/lod/progressive_mesh.h>

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

/// Returns a mesh's triangles as a set of bytes: positions, attributes and materials, whatever their order and
/// rotation.
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

/// A position, to find it again.
using Place = std::array<float, 3>;
inline Place place_of(const Mesh& mesh, Index vertex) {
  const Vec3f& p = mesh.positions[vertex];
  return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};
}

/// Returns the ends of all edges that only one face has, or several that lie on one another: of borders, and of cracks.
/// By position and without the edge table: it judges meshes that this has made.
inline std::set<Place> open_places(const Mesh& mesh) {
  std::map<std::pair<Place, Place>, std::set<Place>> beside;
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
    const Place a = place_of(mesh, mesh.corner_vertex(c));
    const Place b = place_of(mesh, mesh.corner_vertex(next_corner(c)));
    beside[std::minmax(a, b)].insert(place_of(mesh, mesh.corner_vertex(previous_corner(c))));
  }
  std::set<Place> places;
  for (const auto& [edge, thirds] : beside) {
    if (thirds.size() > 1) continue;
    places.insert(edge.first);
    places.insert(edge.second);
  }
  return places;
}

inline std::set<Index> vertices_of(const Mesh& mesh, Index face) {
  return {mesh.corner_vertex(3 * face), mesh.corner_vertex(3 * face + 1), mesh.corner_vertex(3 * face + 2)};
}

/// Returns whether each of a mesh's faces is there `count` times, wherever it faces.
inline bool is_layered(const Mesh& mesh, std::size_t count) {
  std::map<std::set<Index>, std::size_t> faces;
  for (Index f = 0; f < mesh.face_count(); ++f) ++faces[vertices_of(mesh, f)];
  return std::all_of(faces.begin(), faces.end(), [&](const auto& entry) { return entry.second == count; });
}

/// Twice the signed area of a face in the first texture.
inline double texture_area(const Mesh& mesh, Index face) {
  const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                  [](const Attribute& a) { return a.name == "TEXCOORD_0"; });
  const auto at = [&](Index corner, std::size_t i) {
    float value = 0;
    std::memcpy(&value, &found->data[8 * std::size_t{mesh.corner_wedge[corner]} + 4 * i], 4);
    return static_cast<double>(value);
  };
  const Index a = 3 * face;
  return (at(a + 1, 0) - at(a, 0)) * (at(a + 2, 1) - at(a, 1)) - (at(a + 1, 1) - at(a, 1)) * (at(a + 2, 0) - at(a, 0));
}

}  // namespace lodestone::test

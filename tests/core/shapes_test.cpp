// The families of shapes keep the promises that the other tests rely on.

#include <algorithm>
#include <set>
#include <utility>

#include <lodestone/core/assemble.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

bool is_clean(const AssemblyReport& report) {
  return report.nonfinite_faces == 0 && report.degenerate_faces == 0 && report.duplicate_faces == 0 &&
         report.unused_points == 0 && report.nonmanifold_edges == 0 && report.cut_vertices == 0;
}

int euler_characteristic(const Mesh& mesh) {
  std::set<std::pair<Index, Index>> edges;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    edges.insert(std::minmax({mesh.corner_vertex(corner), mesh.corner_vertex(next_corner(corner))}));
  }
  return static_cast<int>(mesh.vertex_count()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.face_count());
}

/// Six times the volume that a closed mesh encloses: positive where its faces wind outwards.
double signed_volume(const Mesh& mesh) {
  double volume = 0;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); corner += 3) {
    volume +=
        dot(mesh.corner_position(corner), cross(mesh.corner_position(corner + 1), mesh.corner_position(corner + 2)));
  }
  return volume;
}

}  // namespace

TEST_CASE("manifold shapes assemble without a remark and have their Euler characteristic") {
  for (const NamedShape& shape : manifold_shapes()) {
    INFO(shape.name);
    const auto assembled = assemble(shape.soup);
    REQUIRE(assembled);
    CHECK(is_clean(assembled->report));
    CHECK(assembled->mesh.face_count() == shape.soup.indices.size() / 3);
    CHECK(euler_characteristic(assembled->mesh) == shape.euler_characteristic);
  }
}

TEST_CASE("the other shapes are cut or cleaned") {
  for (const NamedShape& shape : all_shapes()) {
    if (shape.manifold) continue;
    INFO(shape.name);
    const auto assembled = assemble(shape.soup);
    REQUIRE(assembled);
    CHECK_FALSE(is_clean(assembled->report));
  }
}

TEST_CASE("closed shapes wind outwards") {
  for (const TriangleSoup& soup :
       {tetrahedron(), cube(3), icosphere(2, 0.05, 1), torus(12, 8), double_cone(9), seam_cube(2), seam_sphere(8, 6)}) {
    CHECK(signed_volume(assemble(soup)->mesh) > 0);
  }
}

TEST_CASE("seams split wedges, not vertices") {
  const Mesh cube_mesh = assemble(seam_cube(3))->mesh;
  CHECK(cube_mesh.vertex_count() == 56);
  CHECK(cube_mesh.wedge_count() == 6 * 16);
  const Mesh sphere = assemble(seam_sphere(12, 8))->mesh;
  CHECK(sphere.vertex_count() == 12 * 7 + 2);
  CHECK(sphere.wedge_count() > 12 * 7 + 2 + 6);
}

TEST_CASE("seeds repeat and differ") {
  CHECK(grid(5, 0.1, 7).positions == grid(5, 0.1, 7).positions);
  CHECK(grid(5, 0.1, 7).positions != grid(5, 0.1, 8).positions);
}

}  // namespace lodestone::test

#include <lodestone/core/connectivity.h>

#include <map>

#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

std::map<VertexKind, int> kinds(const TriangleSoup& soup) {
  const Mesh mesh = mesh_of(soup);
  const auto connectivity = Connectivity::build(mesh);
  REQUIRE(connectivity);
  std::map<VertexKind, int> counts;
  for (Index v = 0; v < mesh.vertex_count(); ++v) ++counts[connectivity->kind(v)];
  return counts;
}

}  // namespace

TEST_CASE("kinds of vertices: interior and border") {
  auto count = kinds(grid(4, 0, 1));
  CHECK(count[VertexKind::Interior] == 9);
  CHECK(count[VertexKind::Border] == 16);
  count = kinds(icosphere(1, 0, 1));
  CHECK(count[VertexKind::Interior] == 42);
}

TEST_CASE("kinds of vertices: seams make features along them and corners where they meet") {
  auto count = kinds(seam_cube(3));
  CHECK(count[VertexKind::Corner] == 8);
  CHECK(count[VertexKind::Feature] == 12 * 2);
  CHECK(count[VertexKind::Interior] == 6 * 4);
}

TEST_CASE("kinds of vertices: a material border is a feature, its ends at the rim are corners") {
  auto count = kinds(two_material_grid(4));
  CHECK(count[VertexKind::Feature] == 3);
  CHECK(count[VertexKind::Corner] == 2);
}

TEST_CASE("kinds of vertices: copies made by cutting are recognised") {
  CHECK(kinds(bow_tie())[VertexKind::NonManifold] == 2);
  CHECK(kinds(three_at_one_edge())[VertexKind::NonManifold] == 6);
  CHECK(kinds(mobius_strip(8, 2))[VertexKind::NonManifold] > 0);
}

TEST_CASE("a star lists every face of its vertex once, counter-clockwise, and its sectors partition it") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    const auto connectivity = Connectivity::build(mesh);
    REQUIRE(connectivity);
    std::size_t corners = 0;
    Star star;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      if (!connectivity->has_vertex(v)) continue;
      connectivity->gather_star(v, star);
      corners += star.corners.size();
      for (std::size_t i = 0; i < star.corners.size(); ++i) {
        CHECK(connectivity->vertex(star.corners[i]) == v);
        if (i > 0) CHECK(connectivity->swing_left(star.corners[i - 1]) == star.corners[i]);
      }
      CHECK(star.sector_begin.front() == 0);
      CHECK(star.sector_end(star.sector_count() - 1) == star.corners.size());
    }
    CHECK(corners == mesh.corner_wedge.size());
  }
}

TEST_CASE("build refuses a vertex with two fans and a face that repeats a vertex") {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.wedge_vertex = {0, 1, 2, 3, 4};
  mesh.corner_wedge = {0, 1, 2, 0, 3, 4};
  auto built = Connectivity::build(mesh);
  REQUIRE_FALSE(built);
  CHECK(built.error().message == "vertex 0 has 2 faces in more than one fan");
  mesh.corner_wedge = {0, 1, 1};
  CHECK(Connectivity::build(mesh).error().message == "face 0 repeats vertex 1");
}

}  // namespace lodestone::test

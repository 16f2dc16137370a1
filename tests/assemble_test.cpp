#include <lodestone/core/assemble.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lodestone/core/validate.h>

#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

TriangleSoup two_triangles() {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.indices = {0, 1, 2, 3, 4, 5};
  return soup;
}

}  // namespace

TEST_CASE("assemble welds equal positions and keeps every triangle of a clean shape") {
  for (const NamedShape& shape : manifold_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    CHECK(validate(mesh));
    CHECK(mesh.face_count() == shape.soup.indices.size() / 3);
    // Going through a soup again changes nothing: welding is complete.
    CHECK(triangle_set(mesh_of(to_soup(mesh))) == triangle_set(mesh));
  }
}

TEST_CASE("assemble makes every shape manifold") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    CHECK(validate(mesh));
    const auto connectivity = Connectivity::build(mesh);
    REQUIRE(connectivity);
    CHECK(validate(*connectivity));
  }
}

TEST_CASE("assemble joins points at one position into a vertex, and into a wedge only where attributes agree") {
  TriangleSoup soup = two_triangles();
  CHECK(mesh_of(soup).vertex_count() == 4);
  CHECK(mesh_of(soup).wedge_count() == 4);
  Attribute id{"_ID", ComponentType::UInt8, 1, false, {}};
  for (int i = 0; i < 6; ++i) id.data.push_back(std::byte(i));
  soup.attributes.push_back(id);
  CHECK(mesh_of(soup).vertex_count() == 4);
  CHECK(mesh_of(soup).wedge_count() == 6);
}

TEST_CASE("assemble treats minus zero and zero as one place") {
  TriangleSoup soup = two_triangles();
  soup.positions[1].y = -0.0F;
  CHECK(mesh_of(soup).vertex_count() == 4);
}

TEST_CASE("assemble drops what is no triangle and counts it") {
  TriangleSoup soup = two_triangles();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  soup.positions.insert(soup.positions.end(), {{nan, 0, 0}, {INFINITY, 0, 0}, {7, 7, 7}});
  soup.indices.insert(soup.indices.end(), {0, 1, 6, 0, 7, 2, 0, 1, 3, 1, 2, 0});
  const auto assembled = assemble(soup);
  REQUIRE(assembled);
  CHECK(assembled->report.nonfinite_faces == 2);
  CHECK(assembled->report.degenerate_faces == 1);
  CHECK(assembled->report.duplicate_faces == 1);
  CHECK(assembled->report.unused_points == 1);
  CHECK(assembled->mesh.face_count() == 2);
}

TEST_CASE("assemble drops a face as a duplicate only where it equals another in every attribute and in its material") {
  const TriangleSoup once = cube(2);
  const std::size_t faces = once.indices.size() / 3;
  TriangleSoup twice = layered(once, 2);
  CHECK(mesh_of(twice).face_count() == 2 * faces);
  twice.face_material.clear();
  CHECK(assemble(twice)->report.duplicate_faces == faces);
  CHECK(mesh_of(twice).face_count() == faces);
  const std::size_t points = twice.positions.size();
  for (const char* name : {"NORMAL", "TEXCOORD_1", "COLOR_0", "JOINTS_0", "WEIGHTS_0", "TARGET_0:POSITION", "_ID"}) {
    INFO(name);
    Attribute attribute{name, ComponentType::UInt8, 4, false, {}};
    attribute.data.resize(4 * points);
    twice.attributes = {attribute};
    CHECK(mesh_of(twice).face_count() == faces);
    // One byte at one point: the faces there are sheets of their own, those elsewhere are duplicates.
    const Index odd = twice.indices.back();
    twice.attributes[0].data[4 * odd + 3] = std::byte{1};
    const auto kept = static_cast<std::size_t>(std::count(twice.indices.begin(), twice.indices.end(), odd));
    const auto assembled = assemble(twice);
    REQUIRE(assembled);
    CHECK(assembled->report.duplicate_faces == faces - kept);
    CHECK(assembled->mesh.face_count() == faces + kept);
  }
}

TEST_CASE("assemble cuts where sheets meet, without losing a triangle or moving a corner") {
  for (const NamedShape& shape : all_shapes()) {
    if (shape.manifold || shape.name.find("dirty") != std::string::npos) continue;
    INFO(shape.name);
    const auto assembled = assemble(shape.soup);
    REQUIRE(assembled);
    CHECK(assembled->report.nonmanifold_edges + assembled->report.cut_vertices > 0);
    CHECK(assembled->mesh.face_count() == shape.soup.indices.size() / 3);
  }
}

TEST_CASE("sheets that lie on one another stay sheets, whatever order their faces have") {
  for (const NamedShape& sister : manifold_shapes()) {
    if (!sister.soup.face_material.empty()) continue;
    const Mesh once = mesh_of(sister.soup);
    const auto count_borders = [](const Mesh& mesh) {
      const auto connectivity = Connectivity::build(mesh);
      REQUIRE(connectivity);
      REQUIRE(validate(*connectivity));
      std::size_t count = 0;
      for (Index c = 0; c < mesh.corner_wedge.size(); ++c) count += connectivity->opposite(c) == kNoIndex ? 1 : 0;
      return count;
    };
    for (const TriangleSoup& soup : {stacked(sister.soup, 2), layered(sister.soup, 3), two_sided(sister.soup)})
      for (const TriangleSoup& sheets : {soup, shuffled(soup, 1)}) {
        INFO(sister.name);
        const Mesh mesh = mesh_of(sheets);
        const std::size_t count = sheets.indices.size() / std::max<std::size_t>(1, sister.soup.indices.size());
        CHECK(mesh.face_count() == count * once.face_count());
        CHECK(mesh.vertex_count() == count * once.vertex_count());
        CHECK(count_borders(mesh) == count * count_borders(once));
      }
  }
}

TEST_CASE("assemble names the index or length at fault") {
  TriangleSoup soup = two_triangles();
  soup.indices[4] = 6;
  auto result = assemble(soup);
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::InvalidArgument);
  CHECK(result.error().message == "index 4 is 6, beyond the 6 points");
  soup.indices.pop_back();
  CHECK(assemble(soup).error().message == "index count 5 is not a multiple of 3");
  soup.indices = {0, 1, 2};
  soup.attributes.push_back({"NORMAL", ComponentType::Float32, 3, false, {}});
  CHECK(assemble(soup).error().message == "attribute NORMAL has 0 bytes for 6 points of 12");
}

}  // namespace lodestone::test

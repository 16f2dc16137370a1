#include <lodestone/io/write_mesh.h>

#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>

#include "support/data.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

Mesh without_attributes(const Mesh& mesh) {
  TriangleSoup soup = to_soup(mesh);
  soup.attributes.clear();
  soup.face_material.clear();
  return mesh_of(soup);
}

Mesh round_trip(const std::filesystem::path& path, const Mesh& mesh) {
  const auto written = write_mesh(path, mesh);
  INFO((written ? std::string() : written.error().message));
  REQUIRE(written);
  auto file = read_mesh(path);
  INFO((file ? std::string() : file.error().message));
  REQUIRE(file);
  return std::move(file->mesh);
}

}  // namespace

TEST_CASE("every format returns every position bit for bit") {
  const ScratchDirectory scratch;
  for (const NamedShape& shape : manifold_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    for (const char* extension : {".obj", ".ply", ".glb"}) {
      INFO(shape.name << extension);
      const Mesh read = round_trip(scratch / (std::string("mesh") + extension), mesh);
      CHECK(triangle_set(without_attributes(read)) == triangle_set(without_attributes(mesh)));
    }
  }
}

TEST_CASE("glb keeps attributes and materials bit for bit") {
  const ScratchDirectory scratch;
  for (const TriangleSoup& soup : {seam_cube(3), seam_sphere(8, 6), two_material_grid(4)}) {
    Mesh mesh = mesh_of(soup);
    Mesh read = round_trip(scratch / "mesh.glb", mesh);
    // Attributes come back in the order of their names.
    const auto by_name = [](const Attribute& a, const Attribute& b) { return a.name < b.name; };
    std::sort(mesh.attributes.begin(), mesh.attributes.end(), by_name);
    std::sort(read.attributes.begin(), read.attributes.end(), by_name);
    CHECK(triangle_set(read) == triangle_set(mesh));
  }
}

TEST_CASE("obj and ply keep normals bit for bit, texture coordinates but for the turned v") {
  const ScratchDirectory scratch;
  const Mesh mesh = mesh_of(seam_cube(2));
  for (const char* extension : {".obj", ".ply"}) {
    const Mesh read = round_trip(scratch / (std::string("mesh") + extension), mesh);
    REQUIRE(read.attributes.size() == 2);
    CHECK(read.wedge_count() == mesh.wedge_count());
    CHECK(read.attributes[0].name == "NORMAL");
    CHECK(read.attributes[1].name == "TEXCOORD_0");
  }
}

TEST_CASE("an empty mesh can be written") {
  const ScratchDirectory scratch;
  for (const char* extension : {".obj", ".ply", ".glb"})
    CHECK(round_trip(scratch / (std::string("empty") + extension), Mesh{}).face_count() == 0);
}

TEST_CASE("other extensions are refused by name") {
  const auto written = write_mesh("mesh.xyz", Mesh{});
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::Unsupported);
  CHECK_THAT(written.error().message, contains("'xyz'"));
}

}  // namespace lodestone::test

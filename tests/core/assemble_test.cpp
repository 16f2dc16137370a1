#include <lodestone/core/assemble.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include <lodestone/core/validate.h>

#include "support/cad_shapes.h"
#include "support/data.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

TriangleSoup two_triangles() {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.indices = {0, 1, 2, 3, 4, 5};
  return soup;
}

constexpr AssemblyOptions kTurning{.turn_faces = true};

/// Every manifold family, those of engineering among them.
std::vector<NamedShape> sound_shapes() {
  std::vector<NamedShape> shapes = manifold_shapes();
  for (CadShape& shape : cad_shapes(1)) shapes.push_back({shape.name, std::move(shape.soup), true, std::nullopt});
  std::erase_if(shapes, [](const NamedShape& shape) { return shape.soup.indices.empty(); });
  return shapes;
}

bool has_normals(const TriangleSoup& soup) {
  return std::any_of(soup.attributes.begin(), soup.attributes.end(),
                     [](const Attribute& attribute) { return attribute.name == "NORMAL"; });
}

std::size_t count_borders(const Mesh& mesh) {
  const auto connectivity = Connectivity::build(mesh);
  REQUIRE(connectivity);
  REQUIRE(validate(*connectivity));
  std::size_t count = 0;
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) count += connectivity->opposite(c) == kNoIndex ? 1 : 0;
  return count;
}

/// The faces' places, whichever way they wind.
std::multiset<std::set<Place>> places_of(const Mesh& mesh) {
  std::multiset<std::set<Place>> faces;
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3)
    faces.insert({place_of(mesh, mesh.corner_vertex(c)), place_of(mesh, mesh.corner_vertex(c + 1)),
                  place_of(mesh, mesh.corner_vertex(c + 2))});
  return faces;
}

/// Six times the volume that a closed mesh encloses, positive where it looks outwards.
double volume_of(const Mesh& mesh) {
  double volume = 0;
  for (Index f = 0; f < mesh.face_count(); ++f) volume += dot(mesh.corner_position(3 * f), area_vector(mesh, f));
  return volume;
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

TEST_CASE("faces of any winding are turned to wind alike where that is allowed, and closed shapes look outwards") {
  for (const NamedShape& shape : sound_shapes()) {
    const Mesh sound = mesh_of(shape.soup);
    for (const std::uint64_t seed : {1, 2, 3}) {
      INFO(shape.name << ", seed " << seed);
      const auto assembled = assemble(misturned(shape.soup, 0.5, seed), kTurning);
      REQUIRE(assembled);
      CHECK(validate(assembled->mesh));
      CHECK(assembled->report.nonmanifold_edges + assembled->report.cut_vertices == 0);
      CHECK(places_of(assembled->mesh) == places_of(sound));
      CHECK(count_borders(assembled->mesh) == count_borders(sound));
      if (count_borders(sound) == 0) CHECK(volume_of(assembled->mesh) == Approx(volume_of(sound)));
    }
  }
}

TEST_CASE("faces that are few, or that face away from their normals, come back as they were") {
  for (const NamedShape& shape : sound_shapes()) {
    if (shape.name == "12 components") continue;  // of 20 faces each, few
    const double share = has_normals(shape.soup) ? 0.7 : 0.05;
    INFO(shape.name);
    const TriangleSoup soup = misturned(shape.soup, share, 7);
    const auto assembled = assemble(soup, kTurning);
    REQUIRE(assembled);
    CHECK(triangle_set(assembled->mesh) == triangle_set(mesh_of(shape.soup)));
    std::size_t turned = 0;
    for (std::size_t i = 1; i < soup.indices.size(); i += 3) turned += soup.indices[i] != shape.soup.indices[i] ? 1 : 0;
    if (assembled->report.degenerate_faces == 0) CHECK(assembled->report.turned_faces == turned);
  }
}

TEST_CASE("what winds alike is not turned, whichever way it looks, nor what is not allowed to be") {
  for (const NamedShape& shape : all_shapes()) {
    if (shape.name == "disagreeing pair") continue;
    for (const double share : {0.0, 1.0}) {
      INFO(shape.name << ", turned " << share);
      const TriangleSoup soup = misturned(shape.soup, share, 1);
      const auto assembled = assemble(soup, kTurning);
      REQUIRE(assembled);
      CHECK(assembled->report.turned_faces == 0);
      CHECK(triangle_set(assembled->mesh) == triangle_set(mesh_of(soup)));
    }
    CHECK(assemble(misturned(shape.soup, 0.5, 1))->report.turned_faces == 0);
  }
  CHECK(assemble(disagreeing_pair(), kTurning)->report.turned_faces == 1);
  CHECK(assemble(disagreeing_pair(), kTurning)->report.nonmanifold_edges == 0);
}

TEST_CASE("faces whose normals look where they do are not turned") {
  TriangleSoup soup = faceted_sphere(2);
  Attribute& normals = soup.attributes[0];
  REQUIRE(normals.name == "NORMAL");
  for (std::size_t t = 0; t < soup.indices.size(); t += 6) {  // every second face, its three points its own
    std::swap(soup.indices[t + 1], soup.indices[t + 2]);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i) {
        float value = 0;
        std::byte* const stored = &normals.data[12 * soup.indices[t + k] + 4 * i];
        std::memcpy(&value, stored, 4);
        value = -value;
        std::memcpy(stored, &value, 4);
      }
  }
  CHECK(assemble(soup, kTurning)->report.turned_faces == 0);
}

TEST_CASE("a surface of one side is cut across once, whatever the winding of its faces") {
  for (const int width : {1, 2, 5})
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      INFO("width " << width << ", seed " << seed);
      const TriangleSoup strip = mobius_strip(12 * width, width);
      const auto assembled = assemble(misturned(strip, 0.5, seed), kTurning);
      REQUIRE(assembled);
      CHECK(validate(assembled->mesh));
      CHECK(places_of(assembled->mesh) == places_of(mesh_of(strip)));
      CHECK(assembled->report.nonmanifold_edges >= static_cast<std::size_t>(width));
      CHECK(assembled->report.nonmanifold_edges <= static_cast<std::size_t>(5 * width));
    }
}

TEST_CASE("pieces and sheets that meet at an edge are each turned to wind alike") {
  const std::pair<const char*, TriangleSoup> shapes[] = {{"walled cube", walled_cube(6)},
                                                         {"cubes at an edge", cubes_at_an_edge(4)},
                                                         {"bow-tie", bow_tie()},
                                                         {"spheres at a vertex", spheres_at_a_vertex(2)},
                                                         {"many components", many_components(9)}};
  for (const auto& [name, sound] : shapes) {
    INFO(name);
    const auto before = assemble(sound);
    const auto after = assemble(misturned(sound, 0.5, 4), kTurning);
    REQUIRE(before);
    REQUIRE(after);
    CHECK(after->report.nonmanifold_edges == before->report.nonmanifold_edges);
    CHECK(after->mesh.vertex_count() == before->mesh.vertex_count());
    CHECK(count_borders(after->mesh) == count_borders(before->mesh));
  }
}

TEST_CASE("turning faces never makes more cuts, nor loses a face") {
  for (std::uint64_t seed = 0; seed < (kReduced ? 20 : 200); ++seed) {
    INFO("seed " << seed);
    const TriangleSoup soup = random_squares(3, seed);
    const auto given = assemble(soup);
    const auto turned = assemble(soup, kTurning);
    REQUIRE(turned);
    CHECK(validate(turned->mesh));
    CHECK(turned->report.nonmanifold_edges <= given->report.nonmanifold_edges);
    CHECK(places_of(turned->mesh) == places_of(given->mesh));
  }
}

TEST_CASE("faces of different sheets are no duplicates, though no attribute tells them apart") {
  TriangleSoup twice = layered(torus(8, 6), 2);
  twice.face_material.clear();
  const std::size_t points = twice.positions.size();
  twice.point_sheet.assign(points, 7);
  CHECK(assemble(twice)->report.duplicate_faces == twice.indices.size() / 6);
  std::fill_n(twice.point_sheet.begin(), points / 2, Index{1});
  const Mesh mesh = mesh_of(twice);
  CHECK(mesh.face_count() == twice.indices.size() / 3);
  CHECK(validate(mesh));
  CHECK(validate(Connectivity::build(mesh).value()));
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
  soup.point_sheet = {0, 1};
  CHECK(assemble(soup).error().message == "sheet count 2 differs from point count 6");
  soup.point_sheet.clear();
  soup.attributes.push_back({"NORMAL", ComponentType::Float32, 3, false, {}});
  CHECK(assemble(soup).error().message == "attribute NORMAL has 0 bytes for 6 points of 12");
}

}  // namespace lodestone::test

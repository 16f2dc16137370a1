// Tiles that are built one by one, and still fit together.

#include <algorithm>
#include <cmath>
#include <set>

#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/simplify.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/gltf_file.h"
#include "support/mesh_properties.h"
#include "support/program.h"
#include "support/shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

/// A .glb of those triangles of a soup that lie on one side of a plane x = `at`, moved by `shift`.
ByteVector tile(const TriangleSoup& soup, bool left, float at, const Vec3f& shift) {
  std::vector<float> positions;
  for (const Vec3f& p : soup.positions)
    positions.insert(positions.end(), {p.x + shift.x, p.y + shift.y, p.z + shift.z});
  std::vector<Index> indices;
  for (std::size_t i = 0; i < soup.indices.size(); i += 3) {
    const auto lies_left = [&](Index v) { return soup.positions[v].x <= at; };
    const auto first = soup.indices.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::all_of(first, first + 3, lies_left) == left) indices.insert(indices.end(), first, first + 3);
  }
  GltfMaker maker;
  const std::size_t points = maker.add_floats(positions, "VEC3", 3);
  const GltfJson primitive = {{"attributes", {{"POSITION", points}}},
                              {"indices", maker.add_accessor(indices, 5125, "SCALAR", 1)}};
  maker.add("meshes", {{"primitives", GltfJson::array({primitive})}});
  maker.add("scenes", {{"nodes", {0}}});
  maker.add("nodes", {{"mesh", 0}});
  return maker.glb();
}

using Options = std::vector<std::string>;

std::vector<Mesh> built_levels(const std::filesystem::path& in, const Options& options) {
  const ScratchDirectory folder;
  Options words = {"build", in.string(), "-o", (folder / "out.glb").string(), "--no-stream"};
  words.insert(words.end(), options.begin(), options.end());
  const ProgramRun run = run_program(words);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  std::vector<Asset::Level> levels = Asset::read(folder / "out.glb").value().levels().value();
  std::vector<Mesh> meshes;
  for (Asset::Level& level : levels) meshes.push_back(std::move(level.mesh));
  return meshes;
}

std::set<Place> places_near(const Mesh& mesh, float x, float within) {
  std::set<Place> places;
  for (const Place& place : open_places(mesh))
    if (std::abs(place[0] - x) <= within) places.insert(place);
  return places;
}

/// Checks that two tiles have the same points on their common border x = `at` in every level, and how many.
void check_fit(const std::filesystem::path& left, const std::filesystem::path& right, float at, float step,
               std::size_t count, Options options) {
  options.insert(options.end(), {"--lock-border", "--levels", "3", "--ratio", "0.4"});
  const std::vector<Mesh> a = built_levels(left, options), b = built_levels(right, options);
  REQUIRE(a.size() == 3);
  REQUIRE(b.size() == 3);
  CHECK(a[2].face_count() < a[0].face_count() / 3);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::set<Place> border = places_near(a[i], at, step);
      INFO("levels " << i << " and " << j << " at x = " << at);
      CHECK(border.size() == count);
      CHECK(border == places_near(b[j], at, step));
    }
}

}  // namespace

TEST_CASE("tiles built one by one agree on their border in every level, plain and by Draco on one grid") {
  constexpr int kSquares = 16;
  const TriangleSoup soup = terrain(kSquares, 4);
  const ScratchDirectory folder;
  const auto left = folder / "left.glb", right = folder / "right.glb";
  struct Case {
    Vec3f shift;
    float step;
    Options options;
  };
  for (const Case& c : {Case{{0, 0, 0}, 0, {"--no-draco"}}, Case{{-0.75F, -0.25F, 4}, 0.001F, {"--grid-step", "0.001"}},
                        Case{{-6000, 900, 0}, 0.01F, {"--grid-step", "0.01", "--grid-origin=-3,0.2,1e3"}},
                        Case{{-0.75F, -0.25F, 4}, 0.001F, {"--grid-step", "0.001", "--compress", "meshopt"}}}) {
    REQUIRE(write_file(left, tile(soup, true, 0.5F, c.shift)));
    REQUIRE(write_file(right, tile(soup, false, 0.5F, c.shift)));
    check_fit(left, right, 0.5F + c.shift.x, c.step, kSquares + 1, c.options);
  }
}

TEST_CASE("a grid that is none, or too fine for where positions lie, is refused and named") {
  const ScratchDirectory folder;
  const std::string in = (folder / "in.glb").string(), out = (folder / "out.glb").string();
  REQUIRE(write_file(in, tile(terrain(8, 1), true, 2, {})));
  const auto refusal = [&](const Options& options) {
    Options words = {"build", in, "-o", out};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramRun run = run_program(words);
    CHECK(run.exit_code == 1);
    CHECK(!std::filesystem::exists(out));
    return run.err;
  };
  CHECK_THAT(refusal({"--grid-step", "1e-10"}),
             contains("steps of 1e-10 from the grid's origin, more than 5.36871e+08"));
  CHECK_THAT(refusal({"--grid-step", "1e-8", "--compress", "meshopt"}),
             contains("from the grid's origin, more than 8.38861e+06"));
  CHECK_THAT(refusal({"--grid-step", "1", "--grid-origin=1,0,0", "--compress", "meshopt"}), contains("--grid-origin"));
  CHECK_THAT(refusal({"--compress", "zip"}), contains("--compress"));
  CHECK_THAT(refusal({"--compress", "meshopt", "--no-draco"}), contains("--no-draco"));
  CHECK_THAT(refusal({"--grid-step", "0"}), contains("--grid-step"));
  CHECK_THAT(refusal({"--grid-step", "1e-42"}), contains("the grid's step is"));
  CHECK_THAT(refusal({"--grid-step", "1", "--qp", "12"}), contains("--qp"));
  CHECK_THAT(refusal({"--grid-origin", "0,0,0"}), contains("--grid-step"));
}

TEST_CASE("the field's tiles fit together, and what importance locks stays where it was") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const auto field = *models_directory() / "field";
  check_fit(field / "tile-left.glb", field / "tile-right.glb", 1, 0.0001F, 65, {"--grid-step", "0.0001"});
  const auto path = field / "locked-by-importance.glb";
  const Mesh whole = Scene::read(path).value().meshes()[0].mesh;
  const Attribute& importance = whole.attributes.back();
  REQUIRE(importance.name == "_LODESTONE_IMPORTANCE");
  std::set<Place> locked;
  for (Index w = 0; w < whole.wedge_count(); ++w)
    if (attribute_values(importance)[w] >= kLockingImportance) locked.insert(place_of(whole, whole.wedge_vertex[w]));
  CHECK(locked.size() == 102);
  for (const Mesh& level : built_levels(path, {"--ratio", "0.1", "--levels", "2", "--no-draco"})) {
    std::set<Place> places;
    for (Index v = 0; v < level.vertex_count(); ++v) places.insert(place_of(level, v));
    CHECK(std::includes(places.begin(), places.end(), locked.begin(), locked.end()));
  }
}

// What the program's files keep of what they are given, and that its commands agree on what a file holds.

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/gltf_file.h"
#include "support/program.h"
#include "support/shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

std::vector<float> floats_of(std::span<const Vec3f> points) {
  std::vector<float> values;
  for (const Vec3f& p : points) values.insert(values.end(), {p.x, p.y, p.z});
  return values;
}

/// Adds a mesh of a soup's triangles and the attributes it has, and a node that shows it.
std::size_t add_soup(GltfMaker& maker, const TriangleSoup& soup) {
  GltfJson attributes = {{"POSITION", maker.add_floats(floats_of(soup.positions), "VEC3", 3)}};
  for (const Attribute& a : soup.attributes) {
    const std::string type = a.component_count == 1 ? "SCALAR" : "VEC" + std::to_string(a.component_count);
    GltfJson accessor = {{"bufferView", maker.add_view(a.data)},
                         {"componentType", static_cast<int>(a.type)},
                         {"count", soup.positions.size()},
                         {"type", type}};
    attributes[a.name] = maker.add("accessors", std::move(accessor));
  }
  const GltfJson primitive = {{"attributes", attributes},
                              {"indices", maker.add_accessor(soup.indices, 5125, "SCALAR", 1)}};
  return maker.add("nodes", {{"mesh", maker.add("meshes", {{"primitives", GltfJson::array({primitive})}})}});
}

void show_all(GltfMaker& maker) {
  GltfJson nodes = GltfJson::array();
  for (std::size_t i = 0; i < maker.json["nodes"].size(); ++i) nodes.push_back(i);
  maker.add("scenes", {{"nodes", nodes}});
}

TriangleSoup scaled(TriangleSoup soup, float x, float y, float z) {
  for (Vec3f& p : soup.positions) p = {p.x * x, p.y * y, p.z * z};
  return soup;
}

/// A folder, and what the program makes there.
struct Shop {
  ScratchDirectory folder;
  std::string glb = (folder / "out.glb").string();
  std::string report = (folder / "r.json").string();

  std::string put(const std::string& name, GltfMaker& maker) const {
    REQUIRE(write_file(folder / name, maker.glb()));
    return (folder / name).string();
  }
  ProgramRun build(const std::string& in, Words options = {}) const {
    options.insert(options.begin(), {"build", in, "-o", glb, "--report", report});
    return run_program(options);
  }
  Json read_report() const { return Json::parse(file_text(report)); }
  std::size_t extracted_faces() const {
    const std::string out = (folder / "whole.glb").string();
    const ProgramRun run = run_program({"extract", glb, "--error", "0", "-o", out});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return inspected(out)["faces"];
  }
  static Json inspected(const std::string& path) {
    const ProgramRun run = run_program({"inspect", path, "--json"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return Json::parse(run.out);
  }
  static Json compared(const std::string& a, const std::string& b) {
    const ProgramRun run = run_program({"compare", a, b, "--json"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return Json::parse(run.out);
  }
};

double worst_percent(const Json& comparison) {
  const Json& percent = comparison["percent_of_diagonal"];
  return std::max(percent["forward"]["max"].get<double>(), percent["backward"]["max"].get<double>());
}

/// A tube with two joints of which the second is moved; stored as floats, or on a grid that the skin's matrices undo.
GltfMaker bent_tube(bool quantised) {
  constexpr float kSteps = 4095;
  TriangleSoup soup = skinned_cylinder(16, 12);
  std::vector<float> inverse = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  if (quantised) {
    for (Vec3f& p : soup.positions)
      p = {std::round((p.x + 2) / 4 * kSteps), std::round((p.y + 2) / 4 * kSteps), std::round((p.z + 2) / 4 * kSteps)};
    inverse = {4 / kSteps, 0, 0, 0, 0, 4 / kSteps, 0, 0, 0, 0, 4 / kSteps, 0, -2, -2, -2, 1};
  }
  GltfMaker maker;
  const std::size_t node = add_soup(maker, soup);
  maker.json["nodes"][node]["skin"] = 0;
  maker.json["nodes"][node]["scale"] = {1000, 1000, 1000};  // without effect on what is skinned
  maker.add("nodes", {{"name", "joint"}});
  maker.add("nodes", {{"name", "moved joint"}, {"translation", {3, 0, 0}}, {"rotation", {0, 0.6, 0, 0.8}}});
  std::vector<float> matrices = inverse;
  matrices.insert(matrices.end(), inverse.begin(), inverse.end());
  maker.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", maker.add_floats(matrices, "MAT4", 16)}});
  show_all(maker);
  return maker;
}

std::set<float> values_of(const Mesh& mesh, const std::string& name) {
  for (const Attribute& a : mesh.attributes) {
    if (a.name != name) continue;
    const std::vector<float> values = attribute_values(a);
    return {values.begin(), values.end()};
  }
  return {};
}

}  // namespace

TEST_CASE("what Draco's grid collapses is said, and the stream that keeps its floats is whole all the same") {
  GltfMaker maker;
  add_soup(maker, cube(1));
  add_soup(maker, scaled(grid(GENERATE(1, 3), 0, 0), 1, 1e-5F, 1));
  show_all(maker);
  const Shop shop;
  const std::string in = shop.put("in.glb", maker);
  const std::size_t faces = Shop::inspected(in)["faces"];
  SECTION("a grid of the user's collapses it") {
    const ProgramRun run = shop.build(in, {"--qp", "8", "--lossless"});
    REQUIRE(run.exit_code == 0);
    CHECK_THAT(run.err, contains("faces collapse on the grid"));
    CHECK_THAT(run.err, contains(std::to_string(faces - 12) + " of " + std::to_string(faces) + " in level 0"));
  }
  SECTION("one that is fitted does not") {
    const ProgramRun run = shop.build(in);
    REQUIRE(run.exit_code == 0);
    CHECK(run.err.find("collapse") == std::string::npos);
    CHECK(shop.read_report()["output"]["position_bits"] > 14);
  }
  CHECK(shop.extracted_faces() == faces);
}

TEST_CASE("a stream without any level that has area is read") {
  GltfMaker maker;
  add_soup(maker, scaled(grid(4, 0, 0), 1, 1e-5F, 1));
  show_all(maker);
  const Shop shop;
  REQUIRE(shop.build(shop.put("in.glb", maker), {"--qp", "8", "--lossless"}).exit_code == 0);
  CHECK(shop.extracted_faces() == 32);
}

/// The entry of the one target of a run: where its level would be the whole mesh again, it is left out.
const Json& entry_of_target(const Json& report) {
  return report["left_out"].empty() ? report["levels"].back() : report["left_out"][0];
}

TEST_CASE("errors that are asked for count quantisation") {
  GltfMaker maker;
  add_soup(maker, icosphere(3, 0.02, 4));
  show_all(maker);
  const Shop shop;
  const std::string in = shop.put("in.glb", maker);
  for (const char* error : {"0", "1e-7", "0.0001%", "0.01%", "1%"}) {
    CAPTURE(error);
    REQUIRE(shop.build(in, {"--error", error, "--strict"}).exit_code == 0);
    const Json report = shop.read_report();
    const Json& asked = entry_of_target(report);
    const Json& deviation = report["levels"].back()["deviation"];
    CHECK(asked["target_met"] == true);
    const double largest =
        std::max(deviation["forward"]["max"].get<double>(), deviation["backward"]["max"].get<double>());
    CHECK(largest <= asked["target"]["error"].get<double>() + 1e-12);
  }
  SECTION("with bits that are too few, the error cannot be met") {
    const ProgramRun run = shop.build(in, {"--error", "0.01%", "--qp", "10", "--strict"});
    CHECK(run.exit_code == 5);
    CHECK_THAT(run.err, contains("the grid of positions alone moves vertices by"));
    CHECK(shop.build(in, {"--error", "0.01%", "--qp", "10"}).exit_code == 0);
    const Json report = shop.read_report();
    CHECK(entry_of_target(report)["target_met"] == false);
  }
}

TEST_CASE("numbers of things are the original's in every level") {
  TriangleSoup soup = terrain(24, 3);
  std::vector<float> ids;
  for (const Vec3f& p : soup.positions) ids.push_back(1000.0F + 7 * std::floor(p.x * 13));
  const auto bytes = std::as_bytes(std::span(ids));
  soup.attributes = {{"_FEATURE_ID_0", ComponentType::Float32, 1, false, {bytes.begin(), bytes.end()}}};
  GltfMaker maker;
  add_soup(maker, soup);
  show_all(maker);
  const Shop shop;
  REQUIRE(shop.build(shop.put("in.glb", maker)).exit_code == 0);
  const std::set<float> given(ids.begin(), ids.end());
  const std::vector<Asset::Level> levels = Asset::read(shop.glb).value().levels().value();
  REQUIRE(levels.size() == 5);
  for (const Asset::Level& level : levels) {
    const std::set<float> found = values_of(level.mesh, "_FEATURE_ID_0");
    CHECK(std::includes(given.begin(), given.end(), found.begin(), found.end()));
  }
  CHECK(values_of(levels[0].mesh, "_FEATURE_ID_0") == given);
}

TEST_CASE("skins pose what is read, and undo its quantisation") {
  const Shop shop;
  GltfMaker plain = bent_tube(false), quantised = bent_tube(true);
  const std::string a = shop.put("plain.glb", plain), b = shop.put("quantised.glb", quantised);
  CHECK(worst_percent(Shop::compared(a, b)) < 0.1);
  const Json box = Shop::inspected(a)["bounding_box"];
  CHECK(box["high"][0].get<double>() > 2.5);  // the second joint takes its end along
  CHECK(box["diagonal"].get<double>() < 20);
  REQUIRE(shop.build(b, {"--levels", "1"}).exit_code == 0);
  CHECK(worst_percent(Shop::compared(a, shop.glb)) < 0.1);
}

TEST_CASE("inspect and build count alike, in the same units") {
  GltfMaker maker = bent_tube(GENERATE(false, true));
  add_soup(maker, icosphere(2, 0.1, 1));
  maker.add("nodes", {{"mesh", 1}, {"scale", {2, 2, 2}}});
  maker.json.erase("scenes");
  show_all(maker);
  const Shop shop;
  const std::string in = shop.put("in.glb", maker);
  const ProgramRun run = shop.build(in, {"--levels", "3"});
  REQUIRE(run.exit_code == 0);
  const Json report = shop.read_report(), before = Shop::inspected(in), after = Shop::inspected(shop.glb);
  for (const char* count : {"faces", "vertices"}) CHECK(before[count] == report["input"][count]);
  CHECK(before["bounding_box"] == report["input"]["bounding_box"]);
  CHECK(after["diagonal"].get<double>() ==
        test::Approx(report["input"]["bounding_box"]["diagonal"].get<double>()).epsilon(1e-3));
  for (std::size_t i = 0; i < 3; ++i) {
    for (const char* count : {"faces", "vertices", "bytes"})
      CHECK(after["levels"][i][count] == report["levels"][i][count]);
    const Json& deviation = report["levels"][i]["deviation"];
    CHECK(
        after["levels"][i]["deviation"]["max"].get<double>() ==
        test::Approx(std::max(deviation["forward"]["max"].get<double>(), deviation["backward"]["max"].get<double>())));
  }
  CHECK_THAT(run.out, contains("%"));
  CHECK_THAT(run_program({"inspect", shop.glb}).out, contains("%"));
}

TEST_CASE("the bytes of a .gltf are those of all its files") {
  GltfMaker maker;
  add_soup(maker, icosphere(2, 0, 1));
  show_all(maker);
  const Shop shop;
  const std::string in = shop.put("in.glb", maker);
  GltfFile file = GltfFile::read(in);
  file.json["buffers"][0]["uri"] = "a%20buffer.bin";
  file.json["images"] = GltfJson::array({{{"uri", "image.png"}}, {{"uri", "image.png"}}, {{"uri", "missing.png"}}});
  REQUIRE(write_file(shop.folder / "a buffer.bin", file.buffers[0]));
  write_text(shop.folder / "image.png", "\x89PNG\r\n\x1a\n" + std::string(1000, 'x'));
  const std::string text = file.json.dump();
  write_text(shop.folder / "in.gltf", text);
  const Json inspected = Shop::inspected((shop.folder / "in.gltf").string());
  CHECK(inspected["bytes"] ==
        text.size() + file.buffers[0].size() + std::filesystem::file_size(shop.folder / "image.png"));
  CHECK(Shop::inspected(in)["bytes"] == std::filesystem::file_size(in));
}

TEST_CASE("the models of the field keep what they are") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const Shop shop;
  const auto built = [&](const char* name) {
    const auto path = model(name);
    REQUIRE(path);
    const ProgramRun run = shop.build(path->string());
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return Shop::inspected(shop.glb);
  };
  SECTION("a controller's trigger of a third of a millimetre") {
    CHECK(built("field/webxr_generic-trigger_left_trigger.glb")["levels"][0]["compression"] == "draco");
    CHECK(shop.extracted_faces() == 402);
  }
  SECTION("a pipe of 10 km × 0.2 m") {
    if (kReduced) return;  // 19,200 faces
    CHECK(built("field/long-pipe.glb")["levels"][0]["faces"] == 19200);
    CHECK(Asset::read(shop.glb).value().levels().value()[0].mesh.face_count() == 19200);
    CHECK(shop.read_report()["levels"][4]["deviation"]["forward"]["max"].get<double>() < 0.1);
  }
  SECTION("texture coordinates with an outlier") {
    built("field/uv-outlier.glb");
    const Mesh given = read_mesh(*model("field/uv-outlier.glb")).value().mesh;
    CHECK(values_of(Asset::read(shop.glb).value().levels().value()[0].mesh, "TEXCOORD_0") ==
          values_of(given, "TEXCOORD_0"));
  }
  SECTION("numbers of features") {
    built("field/feature-ids.glb");
    const std::set<float> given = values_of(read_mesh(*model("field/feature-ids.glb")).value().mesh, "_FEATURE_ID_0");
    const std::vector<Asset::Level> levels = Asset::read(shop.glb).value().levels().value();
    for (const Asset::Level& level : levels) {
      const std::set<float> found = values_of(level.mesh, "_FEATURE_ID_0");
      CHECK(std::includes(given.begin(), given.end(), found.begin(), found.end()));
    }
  }
  SECTION("thin strips") {
    built("field/cube_and_strip.gltf");
    CHECK(shop.extracted_faces() == 14);
    built("field/thin_strip.obj");
    CHECK(shop.extracted_faces() == 2);
  }
  SECTION("a knight with a skin") {
    const std::string knight = model("skin-morph/Knight.glb")->string();
    const std::size_t faces = Shop::inspected(knight)["faces"];
    REQUIRE(shop.build(knight, {"--levels", "1"}).exit_code == 0);
    CHECK(shop.read_report()["input"]["faces"] == faces);
    CHECK(faces == 6952);
    CHECK(worst_percent(Shop::compared(knight, shop.glb)) < 0.01);
  }
}

// Targets that cannot be met, or only by ruining something: what the levels are then, and how the program says so.

#include <algorithm>

#include <nlohmann/json.hpp>

#include "support/cad_shapes.h"
#include "support/catch.h"
#include "support/data.h"
#include "support/gltf_shapes.h"
#include "support/program.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Json = nlohmann::json;
using Options = std::vector<std::string>;

/// A run of `build` over a file, and its report.
struct Build {
  ProgramRun run;
  Json report;
};

Build build(const std::filesystem::path& in, Options options = {}) {
  const ScratchDirectory folder;
  const std::string report = (folder / "r.json").string();
  options.insert(options.begin(), {"build", in.string(), "-o", (folder / "out.glb").string(), "--report", report});
  Build result{run_program(options), {}};
  INFO(result.run.err);
  REQUIRE(result.run.exit_code == 0);
  result.report = Json::parse(file_text(report));
  return result;
}

/// A file of one scene, and a settings file that locks the nodes called "stuck".
struct Shop {
  ScratchDirectory folder;
  GltfMaker maker;
  std::filesystem::path in = folder / "in.glb";
  std::string settings = (folder / "s.json").string();

  Shop() { write_text(settings, R"({"nodes": {"stuck": {"lock": true}}})"); }
  void add(const char* name, const TriangleSoup& soup, GltfJson members = GltfJson::object()) {
    add_node(maker, name, add_mesh(maker, name, soup), std::move(members));
  }
  Build build(const Options& options = {}) {
    REQUIRE(write_file(in, maker.glb()));
    return ::build(in, options);
  }
};

std::vector<std::size_t> faces_of(const Json& of) {
  std::vector<std::size_t> faces;
  for (const Json& level : of["levels"]) faces.push_back(level["faces"]);
  return faces;
}

double largest(const Json& level) { return level["deviation"]["max"]; }

/// Checks that every level has fewer faces than the one before, and that what would repeat one is accounted for.
void check_falling(const Json& report, std::size_t asked_for) {
  const std::vector<std::size_t> faces = faces_of(report);
  for (std::size_t i = 1; i < faces.size(); ++i) CHECK(faces[i] < faces[i - 1]);
  CHECK(faces.size() + report["left_out"].size() == asked_for);
  for (const Json& left_out : report["left_out"]) CHECK(left_out["level"].get<std::size_t>() < faces.size());
}

}  // namespace

TEST_CASE("parts that cannot have so few faces leave the others what those would have had alone") {
  const auto add_rest = [](Shop& shop) {
    shop.add("large", icosphere(3, 0.02, 1), {{"translation", {4, 0, 0}}});
    shop.add("tiny", icosphere(2, 0, 2), {{"translation", {0, 3, 0}}, {"scale", {0.2, 0.2, 0.2}}});
    add_node(shop.maker, "again", 1, {{"translation", {0, 0, 3}}, {"scale", {0.2, 0.2, 0.2}}});
  };
  Shop alone, beside;
  add_rest(alone);
  add_rest(beside);
  beside.add("stuck", terrain(12, 3));
  struct Case {
    Options with, without;  // the default series; faces that cannot be met, and the others' share of them
    std::size_t level_count;
  };
  for (const Case& c : {Case{{}, {}, 5}, Case{{"--faces", "130"}, {"--faces", "113"}, 2}}) {
    Options options = {"--settings", beside.settings};
    options.insert(options.end(), c.with.begin(), c.with.end());
    const Json rest = alone.build(c.without).report["levels"].back(), both = beside.build(options).report;
    check_falling(both, c.level_count);
    const Json& last = both["levels"].back();
    CHECK(last["target_met"] == false);
    CHECK(last["stopped_by"] == "error");
    CHECK(last["deviation_beyond"].get<double>() > 4 * largest(last));
    CHECK(largest(last) <= 2 * largest(rest));
    CHECK(last["faces"].get<std::size_t>() <= 288 + rest["faces"].get<std::size_t>());
  }
}

TEST_CASE("a card keeps its two triangles, whatever the series of levels asks of the rest") {
  for (const bool with_stuck : {false, true})
    for (const Options& scope : {Options{"--no-draco"}, Options{"--per-mesh", "--no-draco"}}) {
      Shop shop;
      shop.add("card", grid(1, 0, 1), {{"scale", {9, 9, 9}}});
      shop.add("ball", icosphere(2, 0.01, 1));
      if (with_stuck) shop.add("stuck", torus(16, 8), {{"translation", {2, 2, 2}}});
      Options options = {"--levels", "12"};
      if (with_stuck) options.insert(options.end(), {"--settings", shop.settings});
      options.insert(options.end(), scope.begin(), scope.end());
      const Build made = shop.build(options);
      check_falling(made.report, 12);
      for (const std::size_t faces : faces_of(made.report["meshes"][0])) CHECK(faces == 2);
      const Json last = made.report["left_out"].back();
      CHECK(last["stopped_by"] == "error");
      CHECK(last["deviation_beyond"].get<double>() > 4);
      CHECK_THAT(made.run.err, contains("fewer would be up to"));
    }
}

TEST_CASE("a series goes on as long as the error grows with it, to the base, and then ends") {
  Shop shop;
  shop.add("ball", icosphere(3, 0, 1));
  const Json report = shop.build({"--levels", "20"}).report;
  check_falling(report, 20);
  CHECK(faces_of(report).back() == report["stream"]["base_faces"]);
  CHECK(faces_of(report).size() > 8);
  CHECK(report["left_out"].back()["stopped_by"] == "stuck");
}

TEST_CASE("a box of many squares is emptied, and then left alone, but for who asks for less") {
  Shop shop;
  shop.add("box", cube(4));
  const Build made = shop.build();
  CHECK(faces_of(made.report) == std::vector<std::size_t>{192, 96, 48, 24, 12});
  const Build further = shop.build({"--levels", "7"});
  CHECK(faces_of(further.report).back() == 12);
  REQUIRE(further.report["left_out"].size() == 2);
  const double diagonal = further.report["input"]["bounding_box"]["diagonal"];
  CHECK(further.report["left_out"][0]["stopped_by"] == "error");
  CHECK(further.report["left_out"][0]["deviation_beyond"].get<double>() > 0.2 * diagonal);
  for (const Options& options : {Options{"--faces", "6"}, Options{"--ratio", "0.035", "--levels", "2"}}) {
    const Json asked = shop.build(options).report;
    CHECK(faces_of(asked).back() == 6);
    CHECK(asked["levels"].back()["target_met"] == true);
    CHECK(asked["levels"].back()["stopped_by"] == "faces");
  }
  const Json fewest = shop.build({"--faces", "1"}).report;
  CHECK(faces_of(fewest).back() == 12);
  CHECK(fewest["levels"].back()["stopped_by"] == "error");
}

TEST_CASE("small shapes go on as long as what is measured of them does not leap, whatever their bounds say") {
  std::vector<TriangleSoup> shapes = {cylinder(8, 2), cut_box(45), rod(10)};
  for (const int subdivisions : {0, 1})
    for (const double noise : {0.0, 0.04}) shapes.push_back(icosphere(subdivisions, noise, 1));
  for (const TriangleSoup& soup : shapes) {
    Shop shop;
    shop.add("shape", soup);
    const Json series = shop.build().report;
    check_falling(series, 5);
    const double diagonal = series["input"]["bounding_box"]["diagonal"];
    const auto ended = [](const Json& level) { return level["stopped_by"] == "error"; };
    for (const Json& left_out : series["left_out"]) {
      if (!ended(left_out)) continue;
      const std::size_t faces = left_out["target"]["faces"];
      INFO(series["levels"][0]["faces"] << " faces, stopped before " << faces);
      const Json asked = shop.build({"--faces", std::to_string(faces)}).report;
      CHECK(largest(asked["levels"].back()) > 0.16 * diagonal);
      break;
    }
  }
}

TEST_CASE("of very few faces nobody asks for none of them") {
  for (const int faces : {1, 2, 3, 5}) {
    Shop shop;
    shop.add("few", fan(faces + 2, 0.5));
    shop.maker.json["accessors"][1]["count"] = 3 * faces;
    for (const Options& scope : {Options{}, Options{"--per-mesh"}}) {
      INFO(faces << " faces");
      const Build made = shop.build(scope);
      check_falling(made.report, 5);
      CHECK(faces_of(made.report).front() == static_cast<std::size_t>(faces));
      CHECK(faces_of(made.report).back() >= 1);
      CHECK_THAT(made.run.err, !contains("0 faces were asked for") && !contains("1, 1"));
      if (faces == 1) CHECK(made.run.err.empty());
    }
  }
}

TEST_CASE("the field's palm keeps its water, and its levels their shape") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const auto path = *models_directory() / "gltf/PalmTree/PalmTree.gltf";
  const Json report = build(path).report;
  check_falling(report, 5);
  const double diagonal = report["input"]["bounding_box"]["diagonal"];
  for (const Json& level : report["levels"]) CHECK(largest(level) < 0.006 * diagonal);
  for (const Json& mesh : report["meshes"])
    if (mesh["name"] == "Landscape_plane")
      for (const std::size_t faces : faces_of(mesh)) CHECK(faces == 2);
  const Json leaf = build(*models_directory() / "field/sphere-and-doubled-leaf.glb").report;
  check_falling(leaf, 5);
  for (const Json& level : leaf["levels"])
    CHECK(largest(level) < 0.03 * leaf["input"]["bounding_box"]["diagonal"].get<double>());
}

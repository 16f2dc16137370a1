// What the program makes of scenes of several meshes: shared targets, one file per level, extraction.

#include <cmath>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/gltf_shapes.h"
#include "support/program.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

/// A large smooth ball, and a small rough one that stands there twice, once enlarged.
struct SceneShop {
  ScratchDirectory folder;
  std::string in = (folder / "in.glb").string();
  std::string glb = (folder / "out.glb").string();
  std::string report = (folder / "r.json").string();

  SceneShop() {
    GltfMaker maker;
    add_mesh(maker, "smooth", icosphere(3, 0, 1));
    add_mesh(maker, "rough", icosphere(3, 0.1, 2));
    maker.add("scenes", {{"nodes", {0, 1, 2}}});
    maker.add("nodes", {{"name", "large"}, {"mesh", 0}, {"scale", {4, 4, 4}}});
    maker.add("nodes", {{"name", "small"}, {"mesh", 1}, {"translation", {9, 0, 0}}});
    maker.add("nodes", {{"name", "middle"}, {"mesh", 1}, {"translation", {0, 9, 0}}, {"scale", {2, 2, 2}}});
    REQUIRE(write_file(in, maker.glb()));
  }

  ProgramRun build(std::vector<std::string> options) const {
    options.insert(options.begin(), {"build", in, "-o", glb, "--report", report});
    return run_program(options);
  }
  Json read_report() const { return Json::parse(file_text(report)); }
};

std::size_t faces_of(const Json& report, std::size_t mesh, std::size_t level) {
  return report["meshes"][mesh]["levels"][level]["faces"];
}

constexpr std::size_t kBallFaces = 1280;

}  // namespace

TEST_CASE("a ratio is shared by the scene: faces go where they keep the error small") {
  const SceneShop shop;
  REQUIRE(shop.build({"--levels", "3", "--ratio", "0.4", "--placement", "subset"}).exit_code == 0);
  const Json report = shop.read_report();
  CHECK(report["input"]["faces"] == 3 * kBallFaces);
  for (std::size_t level = 1; level < 3; ++level) {
    const std::size_t drawn = report["levels"][level]["faces"];
    const double most = 3 * kBallFaces * std::pow(0.4, level);
    CHECK(static_cast<double>(drawn) <= most);
    CHECK(static_cast<double>(drawn) > most - 6);
    CHECK(drawn == faces_of(report, 0, level) + 2 * faces_of(report, 1, level));
  }
  // The two end up with errors of one size in the world, not with one share of their faces.
  const auto largest = [&](std::size_t mesh) {
    return report["meshes"][mesh]["levels"][2]["deviation"]["forward"]["max"].get<double>() *
           report["meshes"][mesh]["scale"].get<double>();
  };
  CHECK(std::max(largest(0), largest(1)) < 3 * std::min(largest(0), largest(1)));
  CHECK(faces_of(report, 0, 2) != faces_of(report, 1, 2));
}

TEST_CASE("with --per-mesh each mesh gets the target itself") {
  const SceneShop shop;
  REQUIRE(shop.build({"--levels", "2", "--ratio", "0.25", "--per-mesh"}).exit_code == 0);
  Json report = shop.read_report();
  for (const std::size_t mesh : {0, 1}) {
    CHECK(faces_of(report, mesh, 1) <= kBallFaces / 4);
    CHECK(faces_of(report, mesh, 1) > kBallFaces / 4 - 3);
  }
  CHECK(report["settings"]["per_mesh"] == true);
  REQUIRE(shop.build({"--faces", "100", "--per-mesh"}).exit_code == 0);
  report = shop.read_report();
  for (const std::size_t mesh : {0, 1}) CHECK(faces_of(report, mesh, 1) <= 100);
}

TEST_CASE("errors are of the world: scale counts") {
  const SceneShop shop;
  REQUIRE(shop.build({"--error", "0.05,0.5%"}).exit_code == 0);
  const Json report = shop.read_report();
  const double diagonal = report["input"]["bounding_box"]["diagonal"];
  CHECK(diagonal > 15);
  REQUIRE(report["levels"].size() == 3);
  const std::vector<double> most = {0, 0.05, 0.005 * diagonal};
  for (std::size_t level = 1; level < 3; ++level) {
    CHECK(report["levels"][level]["deviation"]["max"].get<double>() <= most[level]);
    for (const Json& mesh : report["meshes"])
      CHECK(mesh["levels"][level]["deviation"]["max"].get<double>() * mesh["scale"].get<double>() <= most[level]);
  }
  CHECK(report["meshes"][0]["scale"].get<double>() == test::Approx(4));
  CHECK(report["meshes"][1]["scale"].get<double>() == test::Approx(2));
  CHECK(report["meshes"][1]["instances"] == 2);
}

TEST_CASE("the file's numbers are the report's") {
  const SceneShop shop;
  REQUIRE(shop.build({"--levels", "3"}).exit_code == 0);
  const Json report = shop.read_report();
  const ProgramRun run = run_program({"inspect", shop.glb, "--json"});
  REQUIRE(run.exit_code == 0);
  const Json inspected = Json::parse(run.out);
  REQUIRE(inspected["levels"].size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json &level = inspected["levels"][i], &reported = report["levels"][i];
    CHECK(level["faces"] == reported["faces"]);
    CHECK(level["bytes"].get<double>() == test::Approx(reported["bytes"].get<double>()).margin(16));
    CHECK(level["deviation"]["max"].get<double>() == test::Approx(reported["deviation"]["max"].get<double>()));
    const Json& ways = reported["deviation"];
    CHECK(level["deviation"]["mean"].get<double>() ==
          test::Approx(std::max(ways["forward"]["mean"].get<double>(), ways["backward"]["mean"].get<double>()))
              .epsilon(0.1));
  }
  CHECK(inspected["streams"].size() == 2);
  CHECK(inspected["streams"][1]["mesh"] == "rough");
  CHECK(inspected["stream"]["bytes"] == report["stream"]["bytes"]);
  CHECK_THAT(run_program({"inspect", shop.glb}).out, contains("compact stream of rough"));
}

TEST_CASE("extract takes a level of the whole scene") {
  const SceneShop shop;
  const bool is_lossless = GENERATE(false, true);
  REQUIRE(shop.build(is_lossless ? Names{"--levels", "2", "--lossless"} : Names{"--levels", "2"}).exit_code == 0);
  const auto extract = [&](const char* option, const char* value, const std::string& to) {
    const std::string path = (shop.folder / to).string();
    REQUIRE(run_program({"extract", shop.glb, option, value, "-o", path}).exit_code == 0);
    return read_mesh(path).value().mesh;
  };
  const auto deviation = [&](const std::string& to) {
    const ProgramRun run = run_program({"compare", shop.in, (shop.folder / to).string(), "--json"});
    return Json::parse(run.out)["deviation"]["max"].get<double>();
  };
  CHECK(extract("--error", "0", "whole.obj").face_count() == 3 * kBallFaces);
  CHECK(deviation("whole.obj") < (is_lossless ? 1e-6 : 1e-3));
  const std::size_t faces = extract("--faces", "900", "faces.ply").face_count();
  CHECK((faces <= 900 && faces > 894));
  extract("--error", "0.1", "error.glb");
  CHECK(deviation("error.glb") <= 0.1);
  const Scene scene = Scene::read(shop.folder / "error.glb").value();
  REQUIRE(scene.meshes().size() == 2);
  CHECK(scene.meshes()[1].nodes == Names{"small", "middle"});
}

TEST_CASE("the profile of files writes a scene for each level, and an index") {
  const SceneShop shop;
  const ProgramRun run = shop.build({"--levels", "3", "--profile", "files"});
  REQUIRE(run.exit_code == 0);
  CHECK(names_in(shop.folder.path()) ==
        Names{"in.glb", "out.json", "out_LOD0.glb", "out_LOD1.glb", "out_LOD2.glb", "r.json"});
  const Json index = Json::parse(file_text(shop.folder / "out.json")), report = shop.read_report();
  REQUIRE(index["levels"].size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& level = index["levels"][i];
    CHECK(level["file"] == "out_LOD" + std::to_string(i) + ".glb");
    const auto path = shop.folder / level["file"].get<std::string>();
    CHECK(level["bytes"] == std::filesystem::file_size(path));
    CHECK(level["faces"] == report["levels"][i]["faces"]);
    const Asset asset = Asset::read(path).value();
    CHECK(asset.level_count() == 1);
    CHECK(asset.streams().value().empty());
    const GltfFile file = GltfFile::read(path);
    CHECK(file.json["nodes"].size() == 3);
    CHECK(file.json["meshes"].size() == 2);
    for (const char* number : {"max", "mean", "rms"}) CHECK(level["deviation"][number].is_number());
  }
  CHECK(index["levels"][2]["screen_coverage"] == 0);
  CHECK(index["levels"][0]["screen_coverage"] > index["levels"][1]["screen_coverage"]);
  CHECK(report["output"]["files"].size() == 3);
}

TEST_CASE("the profile of files writes nothing where one of its files cannot be written") {
  const SceneShop shop;
  std::filesystem::create_directory(shop.folder / "out_LOD1.glb");
  CHECK(shop.build({"--levels", "3", "--profile", "files"}).exit_code == 4);
  CHECK(names_in(shop.folder.path()) == Names{"in.glb", "out_LOD1.glb"});
}

TEST_CASE("build: settings lock and weigh nodes and materials by name, and name what they do not know") {
  const SceneShop shop;
  const std::string settings = (shop.folder / "s.json").string();
  REQUIRE(shop.build({"--ratio", "0.25", "--levels", "2"}).exit_code == 0);
  const std::size_t plain = faces_of(shop.read_report(), 0, 1);

  write_text(settings, R"({"nodes": {"large": {"importance": 8}}})");
  REQUIRE(shop.build({"--ratio", "0.25", "--levels", "2", "--settings", settings}).exit_code == 0);
  CHECK(faces_of(shop.read_report(), 0, 1) > plain);

  write_text(settings, R"({"nodes": {"large": {"lock": true}}})");
  REQUIRE(shop.build({"--ratio", "0.5", "--levels", "2", "--per-mesh", "--settings", settings}).exit_code == 0);
  CHECK(faces_of(shop.read_report(), 0, 1) == 1280);
  CHECK(faces_of(shop.read_report(), 1, 1) <= 640);

  const auto refusal = [&](const char* text) {
    write_text(settings, text);
    const ProgramRun run = shop.build({"--settings", settings});
    CHECK(run.exit_code != 0);
    return run.err;
  };
  CHECK_THAT(refusal(R"({"nodes": {"lrge": {"lock": true}}})"),
             contains("no node of the scene's meshes is called 'lrge'"));
  CHECK_THAT(refusal(R"({"nodes": {"large": {"look": true}}})"), contains("no setting is called 'look'"));
  CHECK_THAT(refusal(R"({"nodes": {"large": {"importance": -1}}})"),
             contains("importance is not a number of 0 or more"));
  CHECK_THAT(refusal("[]"), contains("is not a JSON object"));
}

TEST_CASE("build: weights are checked and reported, and attributes' deviations are in the report") {
  const SceneShop shop;
  CHECK_THAT(shop.build({"--weight", "smell=1"}).err,
             contains("'smell' is not normal, texcoord, color, skin or target"));
  CHECK_THAT(shop.build({"--weight", "normal=x"}).err, contains("'normal=x' does not end in a factor"));
  CHECK(shop.build({"--weight", "normal"}).exit_code == 1);
  const ProgramRun run = run_program({"build", demo_model().string(), "-o", shop.glb, "--report", shop.report,
                                      "--weight", "normal=1,skin=0", "--levels", "2"});
  REQUIRE(run.exit_code == 0);
  const Json report = shop.read_report();
  CHECK(report["settings"]["weights"]["normal"] == 1);
  CHECK(report["settings"]["weights"]["skin"] == 0);
  const Json attributes = report["meshes"][0]["levels"][1]["attributes"];
  REQUIRE(attributes.size() == 1);
  CHECK(attributes[0]["name"] == "NORMAL");
  CHECK(attributes[0]["mean"] > 0);
}

TEST_CASE("build: an attribute of importance keeps its vertices, and a bad one is named") {
  const ScratchDirectory folder;
  const std::string in = (folder / "in.glb").string(), out = (folder / "out.glb").string();
  const std::string report = (folder / "r.json").string();
  const auto make = [&](float front) {
    GltfMaker maker;
    const TriangleSoup soup = icosphere(4, 0.01, 3);
    std::vector<float> positions, importance;
    for (const Vec3f& p : soup.positions) {
      positions.insert(positions.end(), {p.x, p.y, p.z});
      importance.push_back(p.x > 0 ? front : 1);
    }
    const std::size_t vertices = maker.add_floats(positions, "VEC3", 3);
    const std::size_t values = maker.add_floats(importance, "SCALAR", 1);
    const std::size_t indices = maker.add_accessor(soup.indices, 5125, "SCALAR", 1);
    const GltfJson primitive = {{"attributes", {{"POSITION", vertices}, {"_LODESTONE_IMPORTANCE", values}}},
                                {"indices", indices}};
    maker.add("meshes", {{"primitives", GltfJson::array({primitive})}});
    maker.add("scenes", {{"nodes", {0}}});
    maker.add("nodes", {{"mesh", 0}});
    REQUIRE(write_file(in, maker.glb()));
    return run_program({"build", in, "-o", out, "--report", report, "--faces", "100"});
  };
  REQUIRE(make(1000).exit_code == 0);
  const Json locked = Json::parse(file_text(report));
  CHECK(locked["levels"][1]["target_met"] == false);
  CHECK(locked["meshes"][0]["stream"]["blocked"]["locked"] > 1000);
  REQUIRE(make(1).exit_code == 0);
  CHECK(Json::parse(file_text(report))["levels"][1]["target_met"] == true);
  CHECK_THAT(make(-2).err, contains("_LODESTONE_IMPORTANCE has -2"));
}

TEST_CASE("two runs over a scene write the same bytes") {
  const SceneShop shop;
  REQUIRE(shop.build({}).exit_code == 0);
  const std::string first = file_text(shop.glb);
  REQUIRE(shop.build({}).exit_code == 0);
  CHECK(file_text(shop.glb) == first);
}

TEST_CASE("faces in one place with other joints, weights or targets all stay, in the first level and in the stream") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const ScratchDirectory folder;
  for (const auto& [name, faces] : {std::pair{"skinned", std::size_t{896}}, {"morphed", std::size_t{448}}}) {
    INFO(name);
    const std::string in = model(std::string("field/coincident-") + name + ".glb")->string();
    const std::string out = (folder / "out.glb").string();
    const std::string report = (folder / "r.json").string();
    REQUIRE(run_program({"build", in, "-o", out, "--report", report}).exit_code == 0);
    CHECK(faces_of(Json::parse(file_text(report)), 0, 0) == faces);
    const std::string whole = (folder / "whole.glb").string();
    const ProgramRun extracted = run_program({"extract", out, "--error", "0", "-o", whole});
    CHECK(extracted.exit_code == 0);
    CHECK_THAT(extracted.out, contains(std::to_string(faces) + " faces"));
  }
}

TEST_CASE("sheets that lie on one another reach every level, as good as one sheet") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const ScratchDirectory folder;
  struct Expected {
    const char* name;
    std::size_t faces;  // of the coarsest level, at most
    double largest;     // deviation of its vertices, of the diagonal
  };
  for (const auto& [name, faces, largest] : {Expected{"doubled-faces", 4, 1e-6},
                                             {"overlay-materials", 100, 0.012},
                                             {"sphere-and-doubled-leaf", 111, 0.02},
                                             {"coincident-skinned", 56, 0.15},
                                             {"coincident-morphed", 28, 0.25}}) {
    INFO(name);
    const std::string in = model(std::string("field/") + name + ".glb")->string();
    const std::string report = (folder / "r.json").string();
    const std::string out = (folder / "out.glb").string();
    REQUIRE(run_program({"build", in, "-o", out, "--report", report, "--no-draco"}).exit_code == 0);
    const Json parsed = Json::parse(file_text(report));
    CHECK(parsed["levels"].size() == 5);
    CHECK(parsed["levels"].back()["faces"] <= faces);
    CHECK(parsed["levels"].back()["target_met"] == true);
    const double diagonal = parsed["input"]["bounding_box"]["diagonal"];
    CHECK(parsed["levels"].back()["deviation"]["max"].get<double>() <= largest * diagonal);
  }
}

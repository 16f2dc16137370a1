// What the program's commands write and print, on generated meshes.

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/write_mesh.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"
#include "support/shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Json = nlohmann::json;

/// A folder with a mesh in it, and what `build` made of it.
struct Workshop {
  ScratchDirectory folder;
  std::string in = (folder / "in.obj").string();
  std::string glb = (folder / "out.glb").string();
  std::string report = (folder / "r.json").string();

  explicit Workshop(const TriangleSoup& soup) { REQUIRE(write_mesh(in, assemble(soup).value().mesh)); }

  ProgramRun build(std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"build", in, "-o", glb, "--report", report});
    return run_program(options);
  }
  Json read_report() const { return Json::parse(file_text(report)); }
  ProgramRun extract(const std::string& option, const std::string& value, const std::string& to) const {
    return run_program({"extract", glb, option, value, "-o", (folder / to).string()});
  }
  Json compare(const std::string& to) const {
    const ProgramRun run = run_program({"compare", in, (folder / to).string(), "--json"});
    REQUIRE(run.exit_code == 0);
    return Json::parse(run.out);
  }
  std::size_t faces_of(const std::string& name) const { return read_mesh(folder / name).value().mesh.face_count(); }
};

TriangleSoup bumpy_sphere() { return icosphere(kReduced ? 3 : 4, 0.01, 7); }

std::size_t line_count(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

std::vector<std::size_t> faces_of_levels(const Json& report) {
  std::vector<std::size_t> faces;
  for (const Json& level : report["levels"]) faces.push_back(level["faces"]);
  return faces;
}

void check_level(const Json& level) {
  for (const char* number : {"faces", "vertices", "bytes"}) CHECK(level[number].is_number_unsigned());
  for (const char* number : {"deviation_bound", "curvature_error"}) CHECK(level[number].is_number());
  for (const char* way : {"forward", "backward"}) {
    for (const char* number : {"max", "bound", "mean", "rms"}) CHECK(level["deviation"][way][number].is_number());
  }
  CHECK(level["stopped_by"].is_string());
  CHECK(level["target_met"].is_boolean());
}

}  // namespace

TEST_CASE("build prints a table, and with --quiet nothing") {
  const Workshop shop(bumpy_sphere());
  const ProgramRun loud = shop.build();
  CHECK(loud.exit_code == 0);
  CHECK(loud.err.empty());
  CHECK_THAT(loud.out, contains("faces"));
  CHECK(line_count(loud.out) == 1 + 5 + 2);

  const ProgramRun quiet = shop.build({"--quiet"});
  CHECK(quiet.exit_code == 0);
  CHECK(quiet.out.empty());
  CHECK(quiet.err.empty());
}

TEST_CASE("the report has its schema's members") {
  const Workshop shop(bumpy_sphere());
  REQUIRE(shop.build().exit_code == 0);
  const Json report = shop.read_report();
  CHECK(report["schema_version"] == 1);
  CHECK(report["tool"]["name"] == "lodestone");
  CHECK(report["input"]["path"] == shop.in);
  CHECK(report["input"]["faces"] == report["levels"][0]["faces"]);
  CHECK(report["input"]["bounding_box"]["diagonal"].get<double>() > 1);
  CHECK(report["input"]["assembly"]["degenerate_faces"] == 0);
  CHECK(report["input"]["notes"].is_array());
  CHECK(report["settings"]["effort"] == 5);
  CHECK(report["settings"]["metric"] == "hybrid");
  REQUIRE(report["levels"].size() == 5);
  for (const Json& level : report["levels"]) check_level(level);
  for (const char* number : {"bytes", "records", "rounds", "base_faces"}) {
    CHECK(report["stream"][number].get<std::size_t>() > 0);
  }
  CHECK(report["stream"]["stopped_by"].is_string());
  for (const char* number : {"locked", "flip", "link", "shape", "texture", "ring", "error"})
    CHECK(report["stream"]["blocked"][number].is_number());
  for (const char* stage : {"read", "simplify", "levels", "write"}) {
    CHECK(report["timings_ms"][stage].get<double>() >= 0);
  }
  CHECK(report["peak_memory_bytes"].get<std::size_t>() > 1'000'000);
  CHECK(report["output"]["bytes"] == std::filesystem::file_size(shop.glb));
}

TEST_CASE("two runs write the same bytes") {
  const Workshop shop(bumpy_sphere());
  REQUIRE(shop.build().exit_code == 0);
  const std::string first = file_text(shop.glb);
  REQUIRE(shop.build().exit_code == 0);
  CHECK(file_text(shop.glb) == first);
}

TEST_CASE("levels keep to what was asked for") {
  const Workshop shop(bumpy_sphere());
  SECTION("ratio") {
    REQUIRE(shop.build({"--levels", "4", "--ratio", "0.3"}).exit_code == 0);
    const auto faces = faces_of_levels(shop.read_report());
    REQUIRE(faces.size() == 4);
    for (std::size_t i = 1; i < 4; ++i) {
      const double most = static_cast<double>(faces[0]) * std::pow(0.3, i);
      CHECK(static_cast<double>(faces[i]) <= most);
      CHECK(static_cast<double>(faces[i]) > most - 3);
    }
  }
  SECTION("faces, in any order") {
    REQUIRE(shop.build({"--faces", "50,300"}).exit_code == 0);
    const auto faces = faces_of_levels(shop.read_report());
    REQUIRE(faces.size() == 3);
    CHECK((faces[1] <= 300 && faces[1] > 297));
    CHECK((faces[2] <= 50 && faces[2] > 47));
  }
  SECTION("faces, without the stream to base them on") {
    REQUIRE(shop.build({"--faces", "300,50", "--no-stream"}).exit_code == 0);
    const Json report = shop.read_report();
    CHECK(faces_of_levels(report)[2] <= 50);
    CHECK(faces_of_levels(report)[2] > 47);
    CHECK(report["levels"][2]["stopped_by"] == "faces");
    CHECK(report["stream"]["bytes"] == 0);
  }
  SECTION("error") {
    REQUIRE(shop.build({"--error", "0.5%,2%"}).exit_code == 0);
    const Json report = shop.read_report();
    const double diagonal = report["input"]["bounding_box"]["diagonal"];
    REQUIRE(report["levels"].size() == 3);
    CHECK(report["levels"][1]["deviation"]["max"].get<double>() <= 0.005 * diagonal);
    CHECK(report["levels"][2]["deviation"]["max"].get<double>() <= 0.02 * diagonal);
    CHECK(report["levels"][2]["faces"] < report["levels"][1]["faces"]);
  }
  SECTION("epsilon, with a metric of the paper") {
    REQUIRE(shop.build({"--metric", "gaussian", "--epsilon", "0.05,0.5"}).exit_code == 0);
    const Json report = shop.read_report();
    CHECK(report["settings"]["metric"] == "gaussian");
    CHECK(report["levels"][1]["curvature_error"].get<double>() <= 0.05);
    CHECK(report["levels"][2]["curvature_error"].get<double>() <= 0.5);
    CHECK(report["levels"][2]["faces"] < report["levels"][1]["faces"]);
  }
  SECTION("only the whole mesh") {
    REQUIRE(shop.build({"--levels", "1"}).exit_code == 0);
    CHECK(faces_of_levels(shop.read_report()).size() == 1);
  }
}

TEST_CASE("the file holds the levels the report lists") {
  const Workshop shop(bumpy_sphere());
  const std::string option = GENERATE("--no-draco", "--qp=12");
  REQUIRE(shop.build({option}).exit_code == 0);
  const auto faces = faces_of_levels(shop.read_report());
  const std::vector<Asset::Level> levels = Asset::read(shop.glb).value().levels().value();
  REQUIRE(levels.size() == faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) CHECK(levels[i].mesh.face_count() == faces[i]);
}

TEST_CASE("the deviations of a level are those of the level in the file") {
  const Workshop shop(seam_sphere(24, 16));
  const std::string option = GENERATE("--no-draco", "--qp=8");
  REQUIRE(shop.build({option, "--levels", "3"}).exit_code == 0);
  const Json report = shop.read_report();
  const std::vector<Asset::Level> levels = Asset::read(shop.glb).value().levels().value();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    CAPTURE(option, i);
    REQUIRE(write_mesh(shop.folder / "level.ply", levels[i].mesh));
    const Json compared = shop.compare("level.ply")["deviation"], reported = report["levels"][i]["deviation"];
    CHECK(reported["max"].get<double>() == test::Approx(compared["max"].get<double>()).epsilon(0.02).margin(1e-9));
    for (const char* way : {"forward", "backward"})
      for (const char* number : {"mean", "rms"})
        CHECK(reported[way][number].get<double>() ==
              test::Approx(compared[way][number].get<double>()).epsilon(0.05).margin(1e-9));
    CHECK(reported["mean_normal_angle_degrees"].get<double>() ==
          test::Approx(compared["mean_normal_angle_degrees"].get<double>()).epsilon(0.05).margin(1e-3));
    CHECK(levels[i].maximum_deviation == test::Approx(reported["max"].get<double>()));
  }
  CHECK((report["levels"][0]["deviation"]["max"].get<double>() > 0) == (option != "--no-draco"));
}

TEST_CASE("extract gives back the whole mesh for an error of 0, on the stream's grid or as it was") {
  const Workshop shop(GENERATE(bumpy_sphere(), grid(12, 0, 1), terrain(16, 3)));
  REQUIRE(shop.build().exit_code == 0);
  REQUIRE(shop.extract("--error", "0", "rounded.ply").exit_code == 0);
  CHECK(shop.faces_of("rounded.ply") == shop.faces_of("in.obj"));
  const Json rounded = shop.compare("rounded.ply");
  CHECK(rounded["deviation"]["max"].get<double>() < rounded["diagonal"].get<double>() / (1 << 14));

  REQUIRE(shop.build({"--lossless"}).exit_code == 0);
  for (const char* name : {"whole.obj", "whole.ply", "whole.glb"}) {
    CAPTURE(name);
    REQUIRE(shop.extract("--error", "0", name).exit_code == 0);
    CHECK(shop.faces_of(name) == shop.faces_of("in.obj"));
    // Nearest points are computed: a point of the surface itself may come out a rounding error away.
    CHECK(shop.compare(name)["deviation"]["max"].get<double>() < 1e-12);
  }
}

TEST_CASE("extract keeps to its target") {
  const Workshop shop(bumpy_sphere());
  REQUIRE(shop.build().exit_code == 0);
  const std::size_t full = shop.faces_of("in.obj");
  REQUIRE(shop.extract("--faces", "101", "faces.obj").exit_code == 0);
  CHECK((shop.faces_of("faces.obj") <= 101 && shop.faces_of("faces.obj") > 98));
  REQUIRE(shop.extract("--ratio", "0.25", "ratio.ply").exit_code == 0);
  CHECK((shop.faces_of("ratio.ply") <= full / 4 && shop.faces_of("ratio.ply") + 3 > full / 4));
  REQUIRE(shop.extract("--ratio", "1", "all.ply").exit_code == 0);
  CHECK(shop.faces_of("all.ply") == full);
  REQUIRE(shop.extract("--error", "1%", "error.glb").exit_code == 0);
  const Json comparison = shop.compare("error.glb");
  CHECK(comparison["deviation"]["max"].get<double>() <= 0.01 * comparison["diagonal"].get<double>());
  CHECK(shop.faces_of("error.glb") < full);
}

TEST_CASE("inspect accounts for every byte of an asset") {
  const Workshop shop(bumpy_sphere());
  REQUIRE(shop.build().exit_code == 0);
  const ProgramRun run = run_program({"inspect", shop.glb, "--json"});
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.empty());
  const Json json = Json::parse(run.out);
  CHECK(json["kind"] == "asset");
  std::size_t bytes = json["other_bytes"].get<std::size_t>() + json["stream"]["bytes"].get<std::size_t>();
  for (const Json& level : json["levels"]) bytes += level["bytes"].get<std::size_t>();
  CHECK(bytes == std::filesystem::file_size(shop.glb));
  CHECK(json["stream"]["chunks"].back()["faces"] == json["levels"][0]["faces"]);
  CHECK_THAT(run_program({"inspect", shop.glb}).out, contains("compact stream of "));
  REQUIRE(shop.build({"--lossless"}).exit_code == 0);
  CHECK_THAT(run_program({"inspect", shop.glb}).out, contains("compact stream of in, version 3."));
}

TEST_CASE("inspect describes any mesh") {
  const Workshop shop(grid(4, 0, 1));
  const Json json = Json::parse(run_program({"inspect", shop.in, "--json"}).out);
  CHECK(json["kind"] == "mesh");
  CHECK(json["faces"] == 32);
  CHECK(json["vertices"] == 25);
  CHECK(json["vertex_kinds"]["interior"] == 9);
  CHECK(json["vertex_kinds"]["border"] == 16);
  CHECK(json["area"].get<double>() == test::Approx(1));
  CHECK_THAT(run_program({"inspect", shop.in}).out, contains("32 faces"));
}

TEST_CASE("compare takes as many samples as asked, and its maximum does not depend on them") {
  const Workshop shop(bumpy_sphere());
  REQUIRE(write_mesh(shop.folder / "smooth.ply", assemble(icosphere(2, 0, 7)).value().mesh));
  const auto deviation = [&](const char* samples) {
    const ProgramRun run =
        run_program({"compare", shop.in, (shop.folder / "smooth.ply").string(), "--json", "--samples", samples});
    REQUIRE(run.exit_code == 0);
    return Json::parse(run.out)["deviation"];
  };
  const Json few = deviation("2000"), many = deviation("300000");
  for (const char* way : {"forward", "backward"}) {
    CHECK(few[way]["samples"].get<double>() == test::Approx(2000).epsilon(0.1));
    CHECK(many[way]["samples"].get<double>() == test::Approx(300000).epsilon(0.1));
    CHECK(few[way]["mean"].get<double>() == test::Approx(many[way]["mean"].get<double>()).epsilon(0.1));
    CHECK(few[way]["max"] == many[way]["max"]);
  }
  CHECK(run_program({"compare", shop.in, shop.in, "--samples", "5"}).exit_code == 1);
}

TEST_CASE("compare is symmetric in its two directions") {
  const Workshop shop(bumpy_sphere());
  REQUIRE(write_mesh(shop.folder / "smooth.ply", assemble(icosphere(2, 0, 7)).value().mesh));
  const Json there = shop.compare("smooth.ply");
  const ProgramRun run = run_program({"compare", (shop.folder / "smooth.ply").string(), shop.in, "--json"});
  const Json back = Json::parse(run.out);
  const auto mean = [](const Json& json, const char* way) { return json["deviation"][way]["mean"].get<double>(); };
  CHECK(mean(there, "forward") == test::Approx(mean(back, "backward")).epsilon(0.02));
  CHECK(mean(there, "forward") > 0);
  CHECK(there["deviation"]["mean_normal_angle_degrees"].get<double>() > 0);
  CHECK_THAT(run_program({"compare", shop.in, shop.in}).out, contains("A to B"));
}

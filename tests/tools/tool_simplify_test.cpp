// `simplify`: one file with fewer faces, of a mesh or of a scene, and nothing beside it.

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/lod/deviation.h>

#include "support/catch.h"
#include "support/gltf_file.h"
#include "support/gltf_shapes.h"
#include "support/program.h"
#include "support/shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

/// A folder with a mesh file, and what is made there of it.
struct Place {
  ScratchDirectory folder;
  std::string in = file("in.obj");

  explicit Place(const TriangleSoup& soup = icosphere(3, 0.1, 1)) { REQUIRE(write_mesh(in, assemble(soup)->mesh)); }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  ProgramRun simplify(const std::string& out, std::vector<std::string> options) const {
    options.insert(options.begin(), {"simplify", in, out});
    return run_program(options);
  }
  Mesh whole() const { return read_mesh(in)->mesh; }
};

/// Drawn: every node's mesh counts.
std::size_t faces_of(const std::string& path) {
  const Scene scene = Scene::read(path).value();
  std::size_t faces = 0;
  for (const SceneMesh& mesh : scene.meshes()) faces += mesh.mesh.face_count() * mesh.instance_count;
  return faces;
}

std::vector<TriangleSoup> shapes() {
  return {icosphere(3, 0.1, 1),   torus(24, 16),  terrain(24, 1),    seam_sphere(24, 16),
          two_material_sphere(3), annulus(32, 8), many_components(4)};
}

}  // namespace

TEST_CASE("simplify: of every shape one file of each kind, with no more faces than asked for") {
  const std::string extension = GENERATE("glb", "gltf", "obj", "ply");
  for (const TriangleSoup& soup : shapes()) {
    const Place place(soup);
    const std::size_t wanted = place.whole().face_count() / 4;
    const std::string out = place.file("out." + extension);
    const ProgramRun run = place.simplify(out, {"--faces", std::to_string(wanted), "-q"});
    CAPTURE(extension, wanted, run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(faces_of(out) <= wanted);
    CHECK(faces_of(out) + 2 >= wanted);  // a removal takes two
    Names made = {"in.obj", "out." + extension};
    if (extension == "gltf") made.insert(made.begin() + 1, "out.bin");
    CHECK(names_in(place.folder.path()) == made);
  }
}

TEST_CASE("simplify: a .glb is an ordinary one, the same as that level of --profile files") {
  const Place place;
  const std::string out = place.file("out.glb");
  REQUIRE(place.simplify(out, {"--ratio", "25%", "-q"}).exit_code == 0);
  const Asset asset = Asset::read(out).value();
  CHECK(asset.level_count() == 1);
  CHECK(asset.streams().value().empty());
  CHECK(file_text(out).find("MSFT_lod") == std::string::npos);
  REQUIRE(run_program(
              {"build", place.in, place.file("b.glb"), "--profile", "files", "--levels", "2", "--ratio", "25%", "-q"})
              .exit_code == 0);
  CHECK(file_text(out) == file_text(place.file("b_LOD1.glb")));
}

TEST_CASE("simplify: an error is kept, as measured on what was written") {
  const std::string name = GENERATE("out.glb", "out.ply");
  for (const TriangleSoup& soup : shapes()) {
    const Place place(soup);
    const std::string out = place.file(name);
    const ProgramRun run = place.simplify(out, {"--error", "1%", "-q"});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    const Mesh whole = place.whole();
    const Mesh level = read_mesh(out)->mesh;
    CHECK(level.face_count() < whole.face_count());
    CHECK(measure_deviation(whole, level).maximum() <= 0.01 * bounding_box(whole).diagonal() * 1.001);
  }
}

TEST_CASE("simplify: faces and an error together go to where the first of them stops") {
  for (const TriangleSoup& soup : shapes()) {
    const Place place(soup);
    const Mesh whole = place.whole();
    const double limit = 0.01 * bounding_box(whole).diagonal();
    const std::string out = place.file("o.ply");
    for (const std::size_t wanted : {whole.face_count() / 2, whole.face_count() / 8, whole.face_count() / 64}) {
      const ProgramRun run = place.simplify(out, {"--faces", std::to_string(wanted), "--error", "1%", "--report",
                                                  place.file("r.json"), "--strict", "-q"});
      CAPTURE(whole.face_count(), wanted, run.err);
      REQUIRE(run.exit_code == 0);
      const Json report = Json::parse(file_text(place.file("r.json")));
      CHECK(report["settings"]["error_limit"]["error_ratio"] == 0.01);
      const Mesh level = read_mesh(out)->mesh;
      CHECK(measure_deviation(whole, level).maximum() <= limit * 1.001);
      const bool by_faces = report["levels"].back()["stopped_by"] == "faces";
      CHECK((by_faces || report["levels"].back()["stopped_by"] == "error"));
      CHECK((by_faces == (level.face_count() <= wanted)));
      if (!by_faces) continue;
      REQUIRE(place.simplify(out, {"--faces", std::to_string(wanted), "-q"}).exit_code == 0);
      CHECK(read_mesh(out)->mesh.face_count() == level.face_count());
    }
  }
}

TEST_CASE("build: no level goes beyond an error beside other targets") {
  const Place place;
  const std::string report = place.file("r.json");
  const ProgramRun run = run_program({"build", place.in, place.file("o.glb"), "--no-stream", "--faces",
                                      "1000,600,300,100", "--error", "1%", "--report", report, "-q"});
  REQUIRE(run.exit_code == 0);
  const Json json = Json::parse(file_text(report));
  REQUIRE(json["levels"].size() >= 2);
  const double limit = 0.01 * json["input"]["bounding_box"]["diagonal"].get<double>();
  for (const Json& level : json["levels"]) CHECK(level["deviation"]["max"] <= limit * 1.001);
  CHECK(json["levels"].back()["stopped_by"] == "error");
  CHECK(json["left_out"].size() + json["levels"].size() == 5);
}

TEST_CASE("simplify: a ratio of 1 writes the whole mesh") {
  const Place place;
  for (const char* name : {"out.glb", "out.ply"}) {
    REQUIRE(place.simplify(place.file(name), {"--ratio", "1", "--compress", "draco", "-q"}).exit_code == 0);
    CHECK(faces_of(place.file(name)) == place.whole().face_count());
  }
  const Mesh written = read_mesh(place.file("out.ply"))->mesh;
  CHECK(measure_deviation(place.whole(), written).maximum() == 0);
}

TEST_CASE("simplify: a scene keeps its nodes, and its triangles lie in the world in other formats") {
  ScratchDirectory folder;
  GltfMaker maker;
  add_mesh(maker, "ball", icosphere(3, 0.1, 1));
  maker.add("scenes", {{"nodes", {0, 1}}});
  maker.add("nodes", {{"name", "one"}, {"mesh", 0}});
  maker.add("nodes", {{"name", "other"}, {"mesh", 0}, {"translation", {9, 0, 0}}});
  const std::string in = (folder / "in.glb").string(), glb = (folder / "o.glb").string(),
                    ply = (folder / "o.ply").string();
  REQUIRE(write_file(in, maker.glb()));
  REQUIRE(run_program({"simplify", in, glb, "--ratio", "0.25", "-q"}).exit_code == 0);
  REQUIRE(run_program({"simplify", in, ply, "--ratio", "0.25", "-q"}).exit_code == 0);
  CHECK(GltfFile::read(glb).json["nodes"].size() == 2);
  CHECK(faces_of(glb) == 640);  // a quarter of two balls
  const Mesh flat = read_mesh(ply)->mesh;
  CHECK(flat.face_count() == 640);
  CHECK(bounding_box(flat).high.x > 9);
}

TEST_CASE("simplify: table, report and page are of the level that was written") {
  const Place place;
  const std::string out = place.file("out.ply");
  const ProgramRun run =
      place.simplify(out, {"--faces", "100", "--report", place.file("r.json"), "--html", place.file("p.html")});
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, contains("out.ply: "));
  const Json report = Json::parse(file_text(place.file("r.json")));
  CHECK(report["settings"]["profile"] == "level");
  CHECK(report["settings"]["stream"] == false);
  REQUIRE(report["levels"].size() == 2);
  CHECK(report["levels"][1]["faces"] == 100);
  CHECK(report["levels"][1]["bytes"] == std::filesystem::file_size(out));
  CHECK(report["output"]["files"].size() == 1);
  const double reported = report["levels"][1]["deviation"]["max"];
  CHECK(reported > 0);
  const Deviation measured = measure_deviation(place.whole(), read_mesh(out)->mesh);
  CHECK(reported >= 0.99 * measured.maximum());
  CHECK(reported <= 1.01 * measured.maximum_bound());
  CHECK_THAT(file_text(place.file("p.html")), contains("<title>Levels of in.obj"));
}

TEST_CASE("simplify: several inputs go into a folder, in the format asked for") {
  const Place place;
  const std::string other = place.file("other.ply"), out = place.file("small/");
  REQUIRE(write_mesh(other, assemble(torus(24, 16))->mesh));
  REQUIRE(run_program({"simplify", place.in, other, "-o", out, "--format", "obj", "--ratio", "0.5", "-q"}).exit_code ==
          0);
  CHECK(names_in(out) == Names{"in.obj", "other.obj"});
}

TEST_CASE("simplify: what cannot be is refused before anything is written") {
  const Place place;
  const auto refused = [&](const std::string& name, const std::vector<std::string>& options, int code,
                           const std::string& word) {
    const ProgramRun run = place.simplify(place.file(name), options);
    CAPTURE(name, run.err);
    CHECK(run.exit_code == code);
    CHECK_THAT(run.err, contains(word));
    CHECK(names_in(place.folder.path()) == Names{"in.obj"});
  };
  refused("o.glb", {}, 1, "give one value");
  refused("o.glb", {"--ratio", "0.5,0.25"}, 1, "one");
  refused("o.glb", {"--ratio", "0.5", "--faces", "9"}, 1, "--faces");
  refused("o.glb", {"--ratio", "0.5", "--error", "0.1%,1%"}, 1, "one value");
  refused("o.stl", {"--ratio", "0.5"}, 1, ".glb, .gltf, .obj or .ply");
  refused("o.lods", {"--ratio", "0.5"}, 1, ".glb, .gltf, .obj or .ply");
  refused("o.obj", {"--ratio", "0.5", "--compress", "meshopt"}, 1, "--compress");
  refused("o.ply", {"--ratio", "0.5", "--qp", "12"}, 1, "--qp");
  refused("o.glb", {"--ratio", "0.5", "--levels", "3"}, 1, "--levels");
  refused("o.glb", {"--faces", "1", "--strict"}, 5, "target not met");
  refused("in.obj", {"--ratio", "0.5"}, 1, "is the input");
}

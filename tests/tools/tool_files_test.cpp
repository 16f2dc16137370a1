// Where the program reads and writes: folders, several inputs, standard streams, .gltf with its files, levels taken
// out.

#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/write_mesh.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using Names = std::vector<std::string>;
namespace fs = std::filesystem;

Mesh ball(int detail = 1) { return assemble(icosphere(detail, 0.02, 1)).value().mesh; }

std::string write_ball(const fs::path& path, int detail = 1) {
  REQUIRE(write_mesh(path, ball(detail)));
  return path.string();
}

ProgramRun run_well(const Names& arguments, const fs::path& input = "/dev/null") {
  ProgramRun run = run_program(arguments, input);
  CAPTURE(arguments, run.err);
  REQUIRE(run.exit_code == 0);
  return run;
}

void check_fails(const Names& arguments, int exit_code, const std::string& says) {
  const ProgramRun run = run_program(arguments);
  CAPTURE(arguments, run.err);
  CHECK(run.exit_code == exit_code);
  CHECK_THAT(run.err, contains("lodestone: error: ") && contains(says));
}

std::vector<std::size_t> level_faces(const std::string& file) {
  std::vector<std::size_t> faces;
  const auto listed = nlohmann::json::parse(run_well({"inspect", file, "--json"}).out);
  for (const auto& level : listed["levels"]) faces.push_back(level["faces"]);
  return faces;
}

std::size_t face_count(const fs::path& file) { return read_mesh(file).value().mesh.face_count(); }

/// Writes a binary STL.
void write_stl(const fs::path& path, const Mesh& mesh) {
  std::string bytes(80, ' ');
  const auto put = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(mesh.face_count()));
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    for (int i = 0; i < 3; ++i) put(0.0f);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto p = mesh.positions[mesh.wedge_vertex[mesh.corner_wedge[3 * face + corner]]];
      for (const float coordinate : {p.x, p.y, p.z}) put(coordinate);
    }
    put(std::uint16_t{0});
  }
  write_text(path, bytes);
}

constexpr const char* kPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg==";

/// A quad whose materials use an image beside it, one below it, one in a data URI, and one in a buffer.
void write_textured(const fs::path& folder) {
  fs::create_directories(folder / "maps");
  write_text(folder / "wood grain.png", "\x89PNG\r\n\x1a\nwood");
  write_text(folder / "maps" / "bark.png", "\x89PNG\r\n\x1a\nbark");
  std::string data;
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  data.append(reinterpret_cast<const char*>(positions), sizeof positions);
  const unsigned short indices[] = {0, 1, 2, 2, 1, 3};
  data.append(reinterpret_cast<const char*>(indices), sizeof indices);
  data += "\x89PNG\r\n\x1a\nbuffered";
  write_text(folder / "quad.bin", data);
  nlohmann::json document = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  document["scenes"] = {{{"nodes", {0}}}};
  document["nodes"] = {{{"mesh", 0}}};
  document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", 0}}}}}};
  document["materials"] = nlohmann::json::array();
  for (int i = 0; i < 4; ++i)
    document["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  for (int i = 0; i < 4; ++i) document["textures"].push_back({{"source", i}});
  document["images"] = {{{"uri", "wood%20grain.png"}},
                        {{"uri", "maps/bark.png"}},
                        {{"uri", std::string("data:image/png;base64,") + kPng}},
                        {{"bufferView", 2}, {"mimeType", "image/png"}, {"name", "leaf.png"}}};
  document["accessors"] = {{{"bufferView", 0},
                            {"componentType", 5126},
                            {"count", 4},
                            {"type", "VEC3"},
                            {"min", {0, 0, 0}},
                            {"max", {1, 1, 0}}},
                           {{"bufferView", 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}};
  document["bufferViews"] = {{{"buffer", 0}, {"byteLength", 48}},
                             {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 12}},
                             {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", data.size() - 60}}};
  document["buffers"] = {{{"uri", "quad.bin"}, {"byteLength", data.size()}}};
  write_text(folder / "quad.gltf", document.dump());
}

}  // namespace

TEST_CASE("several inputs go into a folder under their own names") {
  const ScratchDirectory folder;
  const std::string a = write_ball(folder / "a.obj"), b = write_ball(folder / "b.c.ply");
  for (const std::string out : {"new/deep/", "new", "there"}) {
    CAPTURE(out);
    fs::create_directory(folder / "there");
    const std::string path = (folder.path() / out).string();
    run_well({"build", a, b, "-o", path, "-q"});
    CHECK(names_in(path) == Names{"a.glb", "b.c.glb"});
    fs::remove_all(folder / "new");
  }
  run_well({"build", a, b, (folder / "last").string() + "/", "--format", "gltf", "-q"});
  CHECK(names_in(folder / "last") == Names{"a.bin", "a.gltf", "b.c.bin", "b.c.gltf"});
  run_well({"build", a, "-o", (folder / "one").string() + "/", "--report", (folder / "one").string() + "/"});
  CHECK(names_in(folder / "one") == Names{"a.glb", "a.json"});
}

TEST_CASE("inputs that would become one file are refused, and no folder is left") {
  const ScratchDirectory folder;
  fs::create_directory(folder / "x");
  const std::string a = write_ball(folder / "a.obj"), b = write_ball(folder.path() / "x" / "a.ply");
  const std::string out = (folder / "out").string() + "/";
  check_fails({"build", a, b, "-o", out}, 1, "would both become");
  check_fails({"build", a, a, "-o", out}, 1, "would both become");
  check_fails({"build", a, b, "-o", out, "--ratio", "2"}, 1, "would both become");
  check_fails({"build", a, "-o", out, "--ratio", "2"}, 1, "not a share");
  for (const char* name : {"all.glb", "all.gltf", "all.lods", "all.obj", "all.ply"})
    check_fails({"build", a, b, "-o", (folder / name).string()}, 1, "is a file's name");
  check_fails({"build", a, "-o", (folder / "missing").string() + "/x.glb"}, 4, "does not exist");
  CHECK(names_in(folder.path()) == Names{"a.obj", "x"});
}

TEST_CASE("of several inputs those that are wrong do not keep the others") {
  const ScratchDirectory folder;
  const std::string a = write_ball(folder / "a.obj"), z = write_ball(folder / "z.obj");
  write_text(folder / "m.obj", "nothing");
  const ProgramRun run = run_program({"build", a, (folder / "m.obj").string(), z, "-o", (folder / "out").string()});
  CHECK(run.exit_code == 2);
  CHECK_THAT(run.err, contains("m.obj' is not built: ") && contains("1 of 3 inputs"));
  CHECK(names_in(folder / "out") == Names{"a.glb", "z.glb"});
}

TEST_CASE("no input is written over, however it is named") {
  const ScratchDirectory folder;
  const std::string glb = write_ball(folder / "a.glb"), obj = write_ball(folder / "b.obj");
  fs::create_symlink("a.glb", folder / "link.glb");
  const std::string before = file_text(glb);
  check_fails({"build", glb, glb}, 1, "is the input");
  check_fails({"build", glb, (folder / "link.glb").string()}, 1, "is the input");
  check_fails({"build", glb, obj, "-o", folder.path().string()}, 1, "is the input");
  check_fails({"build", glb, "-o", folder.path().string() + "/"}, 1, "is the input");
  CHECK(file_text(glb) == before);
}

TEST_CASE("capital letters in extensions are as good as small ones") {
  const ScratchDirectory folder;
  const std::string in = write_ball(folder / "A.OBJ");
  for (const char* name : {"O.GLB", "O.GLTF", "O.Glb"}) run_well({"build", in, (folder / name).string(), "-q"});
  const std::string out = (folder / "O.GLB").string();
  for (const char* name : {"x.OBJ", "x.PLY", "x.GLB"}) {
    run_well({"extract", out, "--error", "0", "-o", (folder / name).string()});
    CHECK(face_count(folder / name) == 80);
  }
  run_well({"compare", in, out, "--heatmap", (folder / "h.PLY").string()});
}

TEST_CASE("a .gltf comes with its data and images beside it, and reads back as the .glb does") {
  const ScratchDirectory folder;
  write_textured(folder / "in");
  const std::string in = (folder.path() / "in" / "quad.gltf").string();
  const std::string gltf = (folder / "out").string() + "/my quad.gltf", glb = (folder / "quad.glb").string();
  fs::create_directory(folder / "out");
  run_well({"build", in, gltf, "--ratio", "0.5", "--levels", "2"});
  run_well({"build", in, glb, "--ratio", "0.5", "--levels", "2"});
  CHECK(names_in(folder / "out") ==
        Names{"leaf.png", "maps", "my quad.bin", "my quad.gltf", "my quad_image2.png", "wood grain.png"});
  CHECK(file_text(folder.path() / "out" / "leaf.png") == "\x89PNG\r\n\x1a\nbuffered");
  CHECK(file_text(folder.path() / "out" / "wood grain.png") == "\x89PNG\r\n\x1a\nwood");
  CHECK(file_text(folder.path() / "out" / "maps" / "bark.png") == "\x89PNG\r\n\x1a\nbark");
  const auto document = nlohmann::json::parse(file_text(gltf));
  CHECK(document["buffers"][0]["uri"] == "my%20quad.bin");
  CHECK(document["images"][0]["uri"] == "wood%20grain.png");
  CHECK(file_text(folder.path() / "out" / "my quad.bin").find("buffered") == std::string::npos);
  CHECK(level_faces(gltf) == level_faces(glb));
  for (const std::string& file : {gltf, glb}) run_well({"extract", file, "--error", "0", "-o", file + ".ply"});
  CHECK(file_text(gltf + ".ply") == file_text(glb + ".ply"));
  run_well({"extract", gltf, "--level", "1", "-o", (folder / "level.gltf").string()});
  const auto level = nlohmann::json::parse(file_text(folder / "level.gltf"));
  CHECK(level["materials"].size() == 4);
  CHECK(level["meshes"][0]["primitives"][0]["material"] == 0);
}

TEST_CASE("a .gltf in its input's folder leaves the input as it was") {
  const ScratchDirectory folder;
  write_textured(folder.path());
  const std::string in = (folder / "quad.gltf").string(), data = file_text(folder / "quad.bin");
  run_well({"build", in, (folder / "lod.gltf").string()});
  CHECK(file_text(folder / "quad.bin") == data);
  // A second input's data have the name that the output's would get.
  fs::rename(in, folder / "other.gltf");
  check_fails({"build", (folder / "other.gltf").string(), in}, 4, "the input needs it");
  CHECK(file_text(folder / "quad.bin") == data);
  CHECK_FALSE(fs::exists(in));
}

TEST_CASE("what cannot be written beside a .gltf leaves nothing") {
  const ScratchDirectory folder;
  write_textured(folder / "in");
  fs::create_directories(folder / "out");
  write_text(folder.path() / "out" / "maps", "a file where a folder is needed");
  check_fails({"build", (folder.path() / "in" / "quad.gltf").string(), (folder / "out").string() + "/q.gltf"}, 4,
              "maps");
  CHECK(names_in(folder / "out") == Names{"maps"});
}

TEST_CASE("a level is taken out as it stands in the file") {
  const ScratchDirectory folder;
  REQUIRE(write_mesh(folder / "a.obj", ball(2)));
  for (const char* name : {"a.glb", "a.gltf"}) {
    const std::string file = (folder / name).string();
    run_well({"build", (folder / "a.obj").string(), file, "--levels", "3", "--no-stream"});
    const std::vector<std::size_t> faces = level_faces(file);
    REQUIRE(faces.size() == 3);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const std::string level = std::to_string(i);
      for (const std::string x : {"x.glb", "x.gltf", "x.obj"}) {
        run_well({"extract", file, "--level", level, "-o", (folder / x).string()});
        CHECK(face_count(folder / x) == faces[i]);
      }
    }
    check_fails({"extract", file, "--level", "3", "-o", (folder / "y.glb").string()}, 1, "levels 0 to 2");
  }
  CHECK_FALSE(fs::exists(folder / "y.glb"));
}

TEST_CASE("extract says what it needs to files that were never made for it") {
  const ScratchDirectory folder;
  const std::string out = (folder / "x.glb").string();
  write_text(folder / "text.txt", "hello");
  write_text(folder / "empty.glb", "");
  for (const std::string& in :
       {write_ball(folder / "a.obj"), write_ball(folder / "a.ply"), write_ball(folder / "a.glb"),
        (folder / "text.txt").string(), (folder / "empty.glb").string()})
    check_fails({"extract", in, "--error", "0", "-o", out}, 3, "not a file with a removal stream");
  write_text(folder / "some.json", "{\"name\": 1}");
  check_fails({"extract", (folder / "some.json").string(), "--error", "0", "-o", out}, 2,
              "not a file with a removal stream");
}

TEST_CASE("standard input is read as what it holds") {
  const ScratchDirectory folder;
  const std::string out = (folder / "o.glb").string();
  for (const char* name : {"a.obj", "a.ply", "a.glb", "a.stl"}) {
    CAPTURE(name);
    if (name == std::string("a.stl")) {
      write_stl(folder / name, ball());
    } else {
      write_ball(folder / name);
    }
    run_well({"build", "-", "-o", out, "-q"}, folder / name);
    CHECK(level_faces(out)[0] == 80);
    run_well({"-", out, "-q", "--input-format", std::string(name).substr(2)}, folder / name);
    CHECK_THAT(run_well({"inspect", "-"}, folder / name).out, contains("80 faces"));
    CHECK_THAT(run_well({"compare", "-", out}, folder / name).out, contains("80 faces"));
  }
  CHECK_THAT(run_well({"inspect", "-"}, out).out, contains("compact stream of "));
  run_well({"extract", "-", "--faces", "40", "-o", (folder / "x.obj").string()}, out);
  CHECK(face_count(folder / "x.obj") == 40);
  check_fails({"build", "-", "-o", folder.path().string() + "/"}, 1, "has no name");
  check_fails({"compare", "-", "-"}, 1, "not both");
  check_fails({"build", out, "-o", (folder / "p.glb").string(), "--input-format", "glb"}, 1, "--input-format");
}

TEST_CASE("standard output gets the file and nothing else") {
  const ScratchDirectory folder;
  const std::string in = write_ball(folder / "a.obj"), out = (folder / "o.glb").string();
  run_well({"build", in, out});
  CHECK(run_well({"build", in, "-o", "-"}).out == file_text(out));
  CHECK(run_well({"build", "-", "-"}, in).out.starts_with("glTF"));
  CHECK(nlohmann::json::parse(run_well({"build", in, out, "--report", "-"}).out)["levels"].size() > 1);
  for (const char* format : {"glb", "obj", "ply"}) {
    const std::string text = run_well({"extract", out, "--faces", "40", "-o", "-", "--format", format}).out;
    CHECK(read_mesh_bytes(std::as_bytes(std::span(text)), format).value().mesh.face_count() == 40);
  }
  check_fails({"build", in, "-o", "-", "--report", "-"}, 1, "is the output");
  check_fails({"build", in, "-o", "-", "--format", "gltf"}, 1, "several files");
  check_fails({"build", in, "-o", "-", "--profile", "files"}, 1, "several files");
  CHECK(names_in(folder.path()) == Names{"a.obj", "o.glb"});
}

TEST_CASE("levels that an earlier run left are named") {
  const ScratchDirectory folder;
  const std::string in = write_ball(folder / "a.obj", 2), out = (folder / "town.glb").string();
  const auto warnings = [&](const char* levels) {
    return run_well({"build", in, out, "--profile", "files", "--levels", levels, "-q"}).err;
  };
  CHECK(warnings("3").empty());
  write_text(folder / "town_LODx.glb", "not a level");
  write_text(folder / "town_LOD7.json", "not a level");
  CHECK(warnings("3").empty());
  CHECK_THAT(warnings("2"), contains("warning: 'town_LOD2.glb' is left"));
  write_text(folder / "town_LOD11.glb", "earlier");
  write_text(folder / "town_LOD2.gltf", "earlier");
  CHECK_THAT(warnings("2"), contains("'town_LOD11.glb', 'town_LOD2.glb', 'town_LOD2.gltf' are left"));
  CHECK(file_text(folder / "town_LOD11.glb") == "earlier");
}

}  // namespace lodestone::test

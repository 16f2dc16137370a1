// Streams in files of their own: what build writes, the other commands read.

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"
#include "support/shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

std::filesystem::path write_ball(const ScratchDirectory& folder) {
  std::filesystem::path path = folder / "ball.obj";
  REQUIRE(write_mesh(path, assemble(icosphere(3, 0.02, 1)).value().mesh));
  return path;
}

std::string build_ball(const ScratchDirectory& folder) {
  const std::filesystem::path stream = folder / "ball.lods";
  const ProgramRun run = run_program({"build", write_ball(folder).string(), "-o", stream.string()});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, contains("stream: 638 records in "));
  CHECK_THAT(run.out, contains(" over a base of 4 faces, "));
  CHECK(run.err.find("warning") == std::string::npos);
  return stream.string();
}

}  // namespace

TEST_CASE("build writes a stream that holds the input on its grid") {
  const ScratchDirectory folder;
  const std::string stream = build_ball(folder);
  CHECK(names_in(folder.path()) == std::vector<std::string>{"ball.lods", "ball.obj"});
  StreamReader reader;
  REQUIRE(reader.append(read_file(stream).value()));
  REQUIRE(reader.done());
  CHECK(reader.mesh().record_count() == 638);
  const Mesh level = extract_level(reader.mesh(), kNoIndex);
  const Mesh input = read_mesh(folder / "ball.obj").value().mesh;
  CHECK(level.face_count() == input.face_count());
  CHECK(std::abs(surface_area(level) - surface_area(input)) < 1e-3 * surface_area(input));

  const std::string coarser = (folder / "coarser.lods").string();
  REQUIRE(run_program({"build", (folder / "ball.obj").string(), coarser, "--qp", "9", "-q"}).exit_code == 0);
  CHECK(static_cast<double>(std::filesystem::file_size(coarser)) <
        0.8 * static_cast<double>(std::filesystem::file_size(stream)));
  const ProgramRun piped = run_program({"build", (folder / "ball.obj").string(), "-o", "-", "--format", "lods"});
  CHECK(piped.out == file_text(stream));
}

TEST_CASE("inspect lists a stream's chunks") {
  const ScratchDirectory folder;
  const std::string stream = build_ball(folder);
  const ProgramRun run = run_program({"inspect", stream, "--json"});
  REQUIRE(run.exit_code == 0);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["kind"] == "stream");
  CHECK(json["faces"] == 1280);
  CHECK(json["bytes"] == std::filesystem::file_size(stream));
  REQUIRE(json["chunks"].size() >= 2);
  CHECK(json["chunks"].back()["faces"] == 1280);
  CHECK(json["chunks"].back()["deviation_bound"] == 0);
  std::uint64_t end = json["chunks"][0]["byte_offset"];
  for (const auto& chunk : json["chunks"]) {
    CHECK(chunk["byte_offset"] == end);
    end += chunk["bytes"].get<std::uint64_t>();
  }
  CHECK(end == json["bytes"]);
  CHECK_THAT(run_program({"inspect", stream}).out, contains("bytes so far"));
}

TEST_CASE("streams are coded small or fast, as asked, and inspect says which") {
  const ScratchDirectory folder;
  const std::string small = build_ball(folder), fast = (folder / "fast.lods").string();
  REQUIRE(run_program({"build", (folder / "ball.obj").string(), fast, "--stream-coding", "fast", "-q"}).exit_code == 0);
  StreamReader one, other;
  REQUIRE(one.append(read_file(small).value()));
  REQUIRE(other.append(read_file(fast).value()));
  CHECK(one.mesh().positions == other.mesh().positions);
  CHECK(std::filesystem::file_size(fast) > std::filesystem::file_size(small));
  CHECK_THAT(run_program({"inspect", small, "--stream"}).out, contains("version 3.0, small coding"));
  CHECK_THAT(run_program({"inspect", fast, "--stream"}).out, contains("version 3.1, fast coding"));
  const auto json = nlohmann::json::parse(run_program({"inspect", fast, "--stream", "--json"}).out);
  CHECK(json["streams"][0]["version"] == "3.1");
  CHECK(json["streams"][0]["coding"] == "fast");
  CHECK(run_program({"build", small, fast, "--stream-coding", "quick", "-q"}).exit_code == 1);
}

TEST_CASE("the least efforts code streams fast, unless they are told to, and reports say what was done") {
  const ScratchDirectory folder;
  build_ball(folder);
  const std::string ball = (folder / "ball.obj").string(), stream = (folder / "draft.lods").string();
  const std::string report = (folder / "draft.json").string();
  const auto coding_of = [&](std::vector<std::string> arguments) {
    std::vector<std::string> all = {"build", ball, stream, "-q", "--report", report};
    all.insert(all.end(), arguments.begin(), arguments.end());
    REQUIRE(run_program(all).exit_code == 0);
    const auto inspected = nlohmann::json::parse(run_program({"inspect", stream, "--stream", "--json"}).out);
    const auto said = nlohmann::json::parse(std::ifstream(report))["settings"]["stream_coding"];
    CHECK(inspected["streams"][0]["coding"] == said);
    return said.get<std::string>();
  };
  CHECK(coding_of({"--effort", "1"}) == "fast");
  CHECK(coding_of({"--effort", "2"}) == "fast");
  CHECK(coding_of({"--effort", "3"}) == "small");
  CHECK(coding_of({"--effort", "1", "--stream-coding", "small"}) == "small");
}

TEST_CASE("inspect --stream tells what parts and rounds of a stream take, and they add up to the file") {
  const ScratchDirectory folder;
  const std::string stream = build_ball(folder), suzi = (folder / "suzi.glb").string();
  REQUIRE(run_program(
              {"build", std::string(LODESTONE_SOURCE_DIR) + "/demo/suzi.glb", "-o", suzi, "--profile", "stream", "-q"})
              .exit_code == 0);
  for (const std::string& file : {stream, suzi}) {
    CAPTURE(file);
    const ProgramRun run = run_program({"inspect", file, "--stream", "--json"});
    REQUIRE(run.exit_code == 0);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["kind"] == "parts");
    double sum = 0;
    for (const auto& part : json["parts"]) sum += part["bits"].get<double>();
    CHECK(std::abs(sum - 8 * json["bytes"].get<double>()) < 1e-6);
    REQUIRE(json["streams"].size() == 1);
    const auto& one = json["streams"][0];
    CHECK(one["version"] == "3.0");
    const std::size_t count = one["parts"].size();
    CHECK(count == (file == stream ? 9 : 10));
    std::vector<double> parts(count);
    for (const auto& round : one["rounds"]) {
      REQUIRE(round["bits"].size() == count);
      for (std::size_t i = 0; i < count; ++i) parts[i] += round["bits"][i].get<double>();
    }
    CHECK(parts[0] == 0);
    for (std::size_t i = 1; i < count; ++i) {
      CAPTURE(i);
      CHECK(json["parts"][i]["name"] == one["parts"][i]);
      CHECK(std::abs(parts[i] - json["parts"][i]["bits"].get<double>()) < 1e-6);
    }
    const auto& last = one["rounds"].back();
    CHECK(last["bytes_so_far"] == one["bytes"]);
    CHECK(last["deviation_bound"] == 0);
    CHECK(last["faces"] == one["chunks"].back()["faces"]);
    const ProgramRun shown = run_program({"inspect", file, "--stream"});
    CHECK_THAT(shown.out, contains("bits a vertex"));
    CHECK_THAT(shown.out, contains(file == stream ? "positions" : "NORMAL"));
  }
  CHECK(nlohmann::json::parse(run_program({"inspect", stream, "--stream", "--json"}).out)["bytes"] ==
        std::filesystem::file_size(stream));
}

TEST_CASE("inspect --stream says of what it cannot tell that, and refuses files without a stream") {
  const ScratchDirectory folder;
  const std::string ball = write_ball(folder).string(), old = (folder / "old.lods").string();
  SimplifyOptions options;
  const auto mesh = simplify(read_mesh(ball).value().mesh, options);
  REQUIRE(mesh);
  const std::vector<std::byte> bytes = encode_stream(mesh->mesh).value();
  write_text(old, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  CHECK_THAT(run_program({"inspect", old, "--stream"}).out, contains("not told apart"));
  const auto json = nlohmann::json::parse(run_program({"inspect", old, "--stream", "--json"}).out);
  CHECK(json["streams"][0]["parts"].is_null());
  CHECK(json["streams"][0]["bytes"] == bytes.size());
  CHECK(json["streams"][0]["chunks"].size() >= 2);

  const ProgramRun none = run_program({"inspect", ball, "--stream"});
  CHECK(none.exit_code == 3);
  CHECK_THAT(none.err, contains("nor a stream"));
  const std::string plain = (folder / "plain.glb").string();
  REQUIRE(run_program({"build", ball, "-o", plain, "--no-stream", "-q"}).exit_code == 0);
  CHECK_THAT(run_program({"inspect", plain, "--stream"}).err, contains("none of its meshes has one"));
}

TEST_CASE("extract and compare take a stream like any file, and build does as its input") {
  const ScratchDirectory folder;
  const std::string stream = build_ball(folder), level = (folder / "level.obj").string();
  const ProgramRun extracted = run_program({"extract", stream, "--faces", "100", "-o", level});
  CAPTURE(extracted.err);
  REQUIRE(extracted.exit_code == 0);
  const std::size_t faces = read_mesh(level).value().mesh.face_count();
  CHECK(faces <= 100);
  CHECK(faces > 60);
  REQUIRE(run_program({"extract", stream, "--error", "0", "-o", (folder / "whole.glb").string()}).exit_code == 0);
  const ProgramRun compared = run_program({"compare", stream, (folder / "whole.glb").string(), "--json"});
  REQUIRE(compared.exit_code == 0);
  CHECK(nlohmann::json::parse(compared.out)["percent_of_diagonal"]["forward"]["max"] == 0);
  const ProgramRun built = run_program({"build", stream, "-o", (folder / "ball.glb").string()});
  CHECK(built.exit_code == 0);
  CHECK(run_program({"extract", stream, "--level", "0", "-o", level}).exit_code == 3);
}

TEST_CASE("a stream that ends early is read as far as it goes, and a broken one refused") {
  const ScratchDirectory folder;
  const std::string stream = build_ball(folder);
  StreamReader reader;
  const std::vector<std::byte> bytes = read_file(stream).value();
  REQUIRE(reader.append(bytes));
  const std::string cut = (folder / "cut.lods").string(), torn = (folder / "torn.lods").string();
  const std::string text = file_text(stream);
  write_text(cut, text.substr(0, reader.chunks()[0].bytes.end));
  write_text(torn, text.substr(0, text.size() - 1));
  const ProgramRun run = run_program({"inspect", cut});
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, contains("the stream ends early, with chunk 1 of "));
  const ProgramRun refused = run_program({"inspect", torn});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, contains("ends inside chunk"));
}

TEST_CASE("options that say nothing for a stream are refused by name") {
  const ScratchDirectory folder;
  const std::string ball = write_ball(folder).string(), stream = (folder / "x.lods").string();
  const auto refused = [&](std::vector<std::string> more, int exit_code, const char* words) {
    std::vector<std::string> arguments = {"build", ball, "-o", stream};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_program(arguments);
    CAPTURE(run.err);
    CHECK(run.exit_code == exit_code);
    CHECK_THAT(run.err, contains(words));
    CHECK(!std::filesystem::exists(stream));
  };
  refused({"--levels", "3"}, 1, "--levels: a .lods has every level");
  refused({"--error", "1%"}, 1, "a .lods has every level");
  refused({"--profile", "files"}, 1, "--profile");
  refused({"--no-stream"}, 1, "--no-stream");
  refused({"--faces", "100,10"}, 1, "--report or --html");
  refused({"--grid-step", "0.1"}, 1, "--grid-step");
  refused({"--compress", "none"}, 1, "--compress");
  refused({"--qp", "20"}, 1, "--qp: a stream's positions have 8 to 16 bits, not 20");
  refused({"--qp", "7"}, 1, "not 7");
  refused({"--report", stream}, 1, "is the output");
}

TEST_CASE("a file with a compact stream refuses bits that streams do not have") {
  const ScratchDirectory folder;
  const std::string ball = write_ball(folder).string(), file = (folder / "x.glb").string();
  const ProgramRun refused = run_program({"build", ball, "-o", file, "--profile", "stream", "--qp", "17"});
  CHECK(refused.exit_code == 1);
  CHECK_THAT(refused.err, contains("--qp: a stream's positions have 8 to 16 bits, not 17"));
  CHECK(!std::filesystem::exists(file));
  const ProgramRun built = run_program({"build", ball, "-o", file, "--profile", "stream", "--qp", "16", "-q"});
  CHECK(built.exit_code == 0);
  CHECK(built.err.empty());
  CHECK(run_program({"build", ball, "-o", file, "--qp", "17", "-q"}).err.empty());
}

TEST_CASE("the report of a stream says what its levels are, as they come out of it, and the page shows them") {
  const ScratchDirectory folder;
  const std::string ball = write_ball(folder).string(), stream = (folder / "x.lods").string(),
                    report = (folder / "r.json").string(), page = (folder / "p.html").string();
  REQUIRE(
      run_program({"build", ball, stream, "--report", report, "--html", page, "--faces", "400,50", "-q"}).exit_code ==
      0);
  const auto json = nlohmann::json::parse(file_text(report));
  CHECK(json["settings"]["profile"] == "lods");
  CHECK(json["output"]["bytes"] == std::filesystem::file_size(stream));
  CHECK(json["output"]["position_bits"] == 14);
  CHECK(json["stream"]["bytes"] == std::filesystem::file_size(stream));
  const ProgressiveMesh mesh = read_stream(read_file(stream).value()).value();
  REQUIRE(json["levels"].size() == 3);
  const auto counts = face_counts(mesh);
  std::uint64_t before = 0;
  for (std::size_t i = 3; i-- > 0;) {  // coarse to fine
    CAPTURE(i);
    const auto& level = json["levels"][i];
    const std::size_t faces = level["faces"];
    CHECK(faces <= (i == 0 ? 1280U : i == 1 ? 400U : 50U));
    const auto position = static_cast<Index>(std::find(counts.rbegin(), counts.rend(), faces) - counts.rbegin());
    REQUIRE(position < counts.size());
    const Mesh found = extract_level(mesh, static_cast<Index>(counts.size() - 1 - position));
    const Mesh original = read_mesh(ball).value().mesh;
    CHECK(level["deviation"]["max"].get<double>() ==
          Approx(measure_deviation(original, found).maximum()).epsilon(0.02));
    CHECK(level["deviation_bound"].get<double>() >= 0.99 * level["deviation"]["max"].get<double>() * (i == 0 ? 0 : 1));
    CHECK(level["bytes"].get<std::uint64_t>() >= before);
    before = level["bytes"];
  }
  CHECK(before == std::filesystem::file_size(stream));
  CHECK_THAT(file_text(page), contains("<html"));

  // Without wishes, as many levels as other files have.
  REQUIRE(run_program({"build", ball, stream, "--report", report, "-q"}).exit_code == 0);
  CHECK(nlohmann::json::parse(file_text(report))["levels"].size() == 5);
  CHECK(run_program({"build", ball, stream, "--report", report, "--faces", "1", "--strict", "-q"}).exit_code == 5);
}

TEST_CASE("a stream keeps what is important, and names materials by their numbers in the file") {
  const ScratchDirectory folder;
  const std::string stream = (folder / "x.lods").string(), obj = (folder / "two.obj").string(),
                    settings = (folder / "s.json").string();
  TriangleSoup soup = two_material_grid(12);
  std::string text = "mtllib two.mtl\n";
  std::size_t white = 0;
  for (std::size_t v = 0; v < soup.positions.size(); ++v) {
    const Vec3f& p = soup.positions[v];
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
    text += v % 3 == 0 ? " 1 1 1\n" : " 0.5 0.5 0.5\n";
    white += v % 3 == 0 ? 1 : 0;
  }
  for (std::size_t face = 0; 3 * face < soup.indices.size(); ++face) {
    text += soup.face_material[face] == 0 ? "usemtl floor\nf" : "usemtl wall\nf";
    for (std::size_t k = 0; k < 3; ++k) text += " " + std::to_string(soup.indices[3 * face + k] + 1);
    text += "\n";
  }
  write_text(obj, text);
  write_text(folder / "two.mtl", "newmtl floor\nnewmtl wall\n");
  REQUIRE(run_program({"build", obj, stream, "-q"}).exit_code == 0);
  const ProgressiveMesh usual = read_stream(read_file(stream).value()).value();
  REQUIRE(usual.groups.size() == 2);
  CHECK(usual.groups[0].material == 1);
  CHECK(usual.groups[1].material == 2);

  write_text(settings, R"({"materials": {"wall": {"lock": true}}})");
  const ProgramRun run = run_program({"build", obj, stream, "--settings", settings, "-q"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const ProgressiveMesh kept = read_stream(read_file(stream).value()).value();
  CHECK(kept.groups[1].base_corners.size() == 3 * kept.groups[1].face_count);
  CHECK(kept.groups[0].base_corners.size() < 3 * kept.groups[0].face_count);
  CHECK(usual.base_vertex_count < white);
  REQUIRE(run_program({"build", obj, stream, "--importance", "COLOR_0", "-q"}).exit_code == 0);
  CHECK(read_stream(read_file(stream).value()).value().base_vertex_count >= white);
}

TEST_CASE("a stream has the attributes of its input") {
  const ScratchDirectory folder;
  const std::string stream = (folder / "suzi.lods").string();
  const ProgramRun run =
      run_program({"build", std::string(LODESTONE_SOURCE_DIR) + "/demo/suzi.glb", "-o", stream, "-q"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const auto json = nlohmann::json::parse(run_program({"inspect", stream, "--json"}).out);
  CHECK(json["attributes"] == nlohmann::json::array({"NORMAL"}));
}

TEST_CASE("a .glb of --profile stream: inspect lists its chunks, extract takes any level, compare sees what it shows") {
  const ScratchDirectory folder;
  const std::string in = write_ball(folder).string(), file = (folder / "ball.glb").string();
  REQUIRE(run_program({"build", in, "-o", file, "--profile", "stream", "--faces", "100"}).exit_code == 0);

  const ProgramRun inspected = run_program({"inspect", file, "--json"});
  REQUIRE(inspected.exit_code == 0);
  const auto json = nlohmann::json::parse(inspected.out);
  CHECK(json["levels"].size() == 1);
  CHECK(json["levels"][0]["faces"].get<int>() <= 100);
  CHECK(json["stream"]["version"] == "3.0");
  REQUIRE(!json["stream"]["chunks"].empty());
  CHECK(json["stream"]["chunks"].back()["faces"] == 1280);
  CHECK_THAT(run_program({"inspect", file}).out, contains("1280"));

  for (const int faces : {1280, 500, 20}) {
    const std::string level = (folder / "level.obj").string();
    const ProgramRun run = run_program({"extract", file, level, "--faces", std::to_string(faces)});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    const auto count = read_mesh(level).value().mesh.face_count();
    CHECK(count <= static_cast<std::size_t>(faces));
    CHECK(count >= static_cast<std::size_t>(faces) * 9 / 10);
  }
  CHECK_THAT(run_program({"build", file, (folder / "again.glb").string()}).err, contains("build from the original"));
  CHECK_THAT(run_program({"build", in, file, "--profile", "stream", "--ratio", "0.5,0.1"}).err, contains("one target"));
  CHECK_THAT(run_program({"build", in, file, "--profile", "stream", "--levels", "3"}).err, contains("one target"));
}

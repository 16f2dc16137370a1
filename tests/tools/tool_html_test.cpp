// The pages that --html writes and the heatmaps of --heatmap: whole, with the numbers of the JSON, safe against any
// name.

#include <algorithm>
#include <cmath>
#include <regex>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/write_mesh.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/gltf_file.h"
#include "support/program.h"
#include "support/shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++count;
  return count;
}

/// Returns the page's data, and checks that the page around it is in order and asks for nothing from elsewhere.
Json data_of(const std::string& page) {
  REQUIRE(page.starts_with("<!DOCTYPE html>"));
  CHECK(page.ends_with("</html>\n"));
  CHECK(count_of(page, "<script") == count_of(page, "</script>"));
  CHECK(count_of(page, "<style>") == 1);
  CHECK(count_of(page, "{{") == 0);
  CHECK(count_of(page, "src=") == 0);
  CHECK(std::regex_replace(page, std::regex("http://www\\.w3\\.org/2000/svg"), "").find("http") ==
        page.find("http-equiv"));
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return Json::parse(page.substr(from, page.find("</script>", from) - from));
}

/// Every picture's data and errors are there, as deflated bytes.
void check_blobs(const std::string& page, const Json& data) {
  Names ids;
  for (const Json& picture : data["pictures"]) {
    ids.push_back(picture["data"]);
    if (!picture["errors"].is_null()) ids.push_back(picture["errors"]["data"]);
  }
  for (const std::string& id : ids) {
    const std::string begin = "id=\"" + id + "\">";
    const std::size_t from = page.find(begin);
    REQUIRE(from != page.npos);
    const std::size_t end = page.find("</script>", from);
    const ByteVector bytes = decode_base64(page.substr(from + begin.size(), end - from - begin.size()));
    REQUIRE(bytes.size() > 8);
    CHECK(bytes[0] == std::byte{0x78});
  }
}

void check_spread(const Json& errors) {
  CHECK(errors["p50"].get<double>() <= errors["p90"].get<double>());
  CHECK(errors["p90"].get<double>() <= errors["p99"].get<double>());
  CHECK(errors["p99"].get<double>() <= errors["max"].get<double>());
  double whole = 0;
  for (const Json& share : errors["bins"]) whole += share.get<double>();
  CHECK(whole == test::Approx(1).margin(1e-3));
}

/// A bumpy ball and a coarser, smooth one.
struct Pair {
  ScratchDirectory folder;
  std::string a, b;

  explicit Pair(const std::string& name = "a.obj") : a((folder / name).string()), b((folder / "b.obj").string()) {
    REQUIRE(write_mesh(a, assemble(icosphere(4, 0.02, 3)).value().mesh));
    REQUIRE(write_mesh(b, assemble(icosphere(2, 0, 3)).value().mesh));
  }
  std::string file(const std::string& name) const { return (folder / name).string(); }
};

Json without_timings(Json report) {
  report.erase("timings_ms");
  report.erase("peak_memory_bytes");
  return report;
}

double lightness(const Attribute& colours, std::size_t wedge) {
  const auto component = [&](std::size_t i) {
    const std::size_t at = wedge * colours.element_bytes() + i * component_bytes(colours.type);
    if (colours.type == ComponentType::UInt8) return std::pow(std::to_integer<int>(colours.data[at]) / 255.0, 2.2);
    return (std::to_integer<int>(colours.data[at]) + 256 * std::to_integer<int>(colours.data[at + 1])) / 65535.0;
  };
  return 0.2126 * component(0) + 0.7152 * component(1) + 0.0722 * component(2);
}

}  // namespace

TEST_CASE("compare writes a page with the numbers of its JSON") {
  const Pair pair;
  const ProgramRun run = run_program({"compare", pair.a, pair.b, "--json", "--html", pair.file("page.html")});
  CHECK(run.exit_code == 0);
  CHECK(run.err.empty());
  const std::string page = file_text(pair.folder / "page.html");
  const Json data = data_of(page);
  CHECK(data["numbers"]["kind"] == "compare");
  CHECK(data["numbers"]["comparison"] == Json::parse(run.out));
  CHECK(data["numbers"]["bytes"][0] == std::filesystem::file_size(pair.a));
  REQUIRE(data["pictures"].size() == 2);
  CHECK(data["pictures"][0]["errors"].is_null());
  CHECK(data["pictures"][0]["shown_faces"] == Json::parse(run.out)["a"]["faces"]);
  check_spread(data["pictures"][1]["errors"]);
  // Errors of vertices are rounded to floats, which keeps their order: so is the bound, then.
  CHECK(data["pictures"][1]["errors"]["max"].get<float>() <=
        data["numbers"]["comparison"]["deviation"]["forward"]["bound"].get<float>());
  check_blobs(page, data);
  CHECK(names_in(pair.folder.path()) == Names{"a.obj", "b.obj", "page.html"});
}

TEST_CASE("build writes a page with the numbers of its report, the same in every run") {
  const Pair pair;
  const Names build = {"build",
                       pair.a,
                       "-o",
                       pair.file("out.glb"),
                       "--quiet",
                       "--html",
                       pair.file("page.html"),
                       "--report",
                       pair.file("r.json")};
  REQUIRE(run_program(build).exit_code == 0);
  const std::string page = file_text(pair.folder / "page.html");
  const Json data = data_of(page);
  CHECK(data["numbers"]["kind"] == "build");
  CHECK(data["numbers"]["report"] == without_timings(Json::parse(file_text(pair.folder / "r.json"))));
  const Json& levels = data["numbers"]["report"]["levels"];
  REQUIRE(data["pictures"].size() == levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    CHECK(data["pictures"][i]["faces"] == levels[i]["faces"]);
    if (i > 0) check_spread(data["pictures"][i]["errors"]);
  }
  REQUIRE(data["numbers"]["bounds"].size() > 10);
  for (std::size_t i = 1; i < data["numbers"]["bounds"].size(); ++i) {
    CHECK(data["numbers"]["bounds"][i][0] > data["numbers"]["bounds"][i - 1][0]);
    CHECK(data["numbers"]["bounds"][i][1] <= data["numbers"]["bounds"][i - 1][1]);
  }
  check_blobs(page, data);
  REQUIRE(run_program(build).exit_code == 0);
  CHECK(file_text(pair.folder / "page.html") == page);
}

TEST_CASE("a page can be had of every kind of build") {
  const Pair pair;
  const Names options = GENERATE(Names{"--profile", "files"}, Names{"--no-stream", "--levels", "2"},
                                 Names{"--levels", "1"}, Names{"--vanish", "--faces", "100,1"});
  CAPTURE(options);
  Names build = {"build", pair.a, "-o", pair.file("out.glb"), "--quiet", "--html", pair.file("page.html")};
  build.insert(build.end(), options.begin(), options.end());
  REQUIRE(run_program(build).exit_code == 0);
  const Json data = data_of(file_text(pair.folder / "page.html"));
  CHECK(data["pictures"].size() == data["numbers"]["report"]["levels"].size());
}

TEST_CASE("names are text on the page, never markup") {
  const std::string nasty = "<script>alert(1)<!--&\"'{{data}}.obj";
  const Pair pair(nasty);
  REQUIRE(run_program({"compare", pair.a, pair.b, "--html", pair.file("page.html")}).exit_code == 0);
  REQUIRE(run_program({"build", pair.a, "-o", pair.file("out.glb"), "--quiet", "--html", pair.file("build.html")})
              .exit_code == 0);
  for (const char* name : {"page.html", "build.html"}) {
    std::string page = file_text(pair.folder / name);
    CHECK(count_of(page, "<script>alert") == 0);
    CHECK(count_of(page, "<!--") == 0);
    CHECK_THAT(page, contains("&lt;script&gt;alert(1)&lt;!--&amp;"));
    for (std::size_t at = page.find("{{data}}"); at != page.npos; at = page.find("{{data}}")) page.erase(at, 8);
    CHECK_THAT(data_of(page)["title"].get<std::string>(), contains("<script>alert(1)<!--&\"'"));
  }
}

TEST_CASE("a heatmap has A's geometry, darker where the error is larger") {
  const ScratchDirectory folder;
  const std::string a = (folder / "a.obj").string(), b = (folder / "b.obj").string();
  // A ramp over a plane: the error of a vertex is its height.
  TriangleSoup ramp = grid(12, 0, 1), plane = ramp;
  for (Vec3f& p : ramp.positions) p.z = 0.2f * p.x;
  for (Vec3f& p : plane.positions) p.z = 0, p.x *= 3, p.y *= 3, p.x -= 1, p.y -= 1;
  REQUIRE(write_mesh(a, assemble(ramp).value().mesh));
  REQUIRE(write_mesh(b, assemble(plane).value().mesh));
  const std::string path = (folder / GENERATE("heat.ply", "heat.glb")).string();
  const ProgramRun run = run_program({"compare", a, b, "--heatmap", path});
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, contains("from pale, no error, to dark"));

  const Mesh mesh = read_mesh(path).value().mesh;
  CHECK(mesh.face_count() == read_mesh(a).value().mesh.face_count());
  REQUIRE(mesh.attributes.size() == 1);
  const Attribute& colours = mesh.attributes[0];
  CHECK(colours.name == "COLOR_0");
  std::vector<std::pair<float, double>> by_error;
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w)
    by_error.emplace_back(mesh.positions[mesh.wedge_vertex[w]].z, lightness(colours, w));
  std::sort(by_error.begin(), by_error.end());
  CHECK(by_error.front().second > 0.7);
  CHECK(by_error.back().second < 0.05);
  for (std::size_t i = 1; i < by_error.size(); ++i) {
    CHECK(by_error[i].second <= by_error[i - 1].second + 1e-6);
    if (by_error[i].first > by_error[i - 1].first + 0.01f && by_error[i].first < 0.19f)
      CHECK(by_error[i].second < by_error[i - 1].second);
  }
}

TEST_CASE("pages and heatmaps have to have a place of their own") {
  const Pair pair;
  const std::string glb = pair.file("out.glb");
  const std::vector<Names> wrong = {
      {"compare", pair.a, pair.b, "--html", pair.a},
      {"compare", pair.a, pair.b, "--html", pair.b},
      {"compare", pair.a, pair.b, "--heatmap", pair.file("x.obj")},
      {"compare", pair.a, pair.b, "--heatmap", pair.file("x.ply"), "--html", pair.file("./x.ply")},
      {"build", pair.a, "-o", glb, "--html", glb},
      {"build", pair.a, "-o", glb, "--html", pair.a},
      {"build", pair.a, "-o", glb, "--html", pair.file("r.json"), "--report", pair.file("r.json")},
      {"build", pair.a, "-o", glb, "--profile", "files", "--html", pair.file("out.json")},
  };
  for (const Names& arguments : wrong) {
    CAPTURE(arguments);
    CHECK(run_program(arguments).exit_code == 1);
  }
  CHECK(run_program({"compare", pair.a, pair.b, "--html", pair.file("no/page.html")}).exit_code == 4);
  CHECK(names_in(pair.folder.path()) == Names{"a.obj", "b.obj"});
  CHECK(run_program({"build", pair.a, "-o", glb, "--html", pair.folder.path().string()}).exit_code == 0);
  CHECK(names_in(pair.folder.path()) == Names{"a.html", "a.obj", "b.obj", "out.glb"});
}

TEST_CASE("a page of equal surfaces has no errors to show") {
  const Pair pair;
  REQUIRE(run_program({"compare", pair.b, pair.b, "--html", pair.file("page.html"), "--heatmap", pair.file("x.ply")})
              .exit_code == 0);
  const Json data = data_of(file_text(pair.folder / "page.html"));
  CHECK(data["pictures"][1]["errors"]["max"].get<double>() < 1e-6);
}

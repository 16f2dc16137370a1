// What the program promises to scripts: exit codes, clean standard output, whole output or none.

#include <algorithm>
#include <regex>

#include <lodestone/core/assemble.h>
#include <lodestone/io/write_mesh.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"
#include "support/shapes.h"
#include "support/terminal.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

using Names = std::vector<std::string>;

/// One triangle as glTF, its 36 bytes of positions inline; `extra` adds members to the document.
std::string triangle_gltf(const std::string& extra) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
         "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"
         R"("}])" +
         extra + "}";
}

std::filesystem::path write_sphere(const ScratchDirectory& folder) {
  std::filesystem::path path = folder / "sphere.obj";
  REQUIRE(write_mesh(path, assemble(icosphere(3, 0.02, 1)).value().mesh));
  return path;
}

void check_error(const ProgramRun& run, int exit_code) {
  CAPTURE(run.err);
  CHECK(run.exit_code == exit_code);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, contains("lodestone: error: "));
}

}  // namespace

TEST_CASE("help and version go to standard output") {
  const ProgramRun version = run_program({"--version"});
  CHECK(version.exit_code == 0);
  CHECK_THAT(version.out, contains("lodestone "));
  CHECK(version.err.empty());

  CHECK_THAT(run_program({"--help"}).out, contains("Exit codes"));
  for (const char* command : {"build", "extract", "inspect", "compare"}) {
    const ProgramRun help = run_program({command, "--help"});
    CAPTURE(command);
    CHECK(help.exit_code == 0);
    CHECK_THAT(help.out, contains("Example"));
    CHECK(help.err.empty());
  }
}

TEST_CASE("wrong usage exits with 1 and says what is wrong") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string out = (folder / "out.glb").string();
  const std::vector<Names> wrong = {
      {},
      {"nonsense"},
      {"build"},
      {"build", in},
      {"build", in, "-o", out, "--no-such-option"},
      {"build", in, "-o", (folder / "out.obj").string()},
      {"build", in, "-o", out, "--faces", "20,x"},
      {"build", in, "-o", out, "--faces", "1.5"},
      {"build", in, "-o", out, "--faces", "0"},
      {"build", in, "-o", out, "--faces", ""},
      {"build", in, "-o", out, "--error", "1%%"},
      {"build", in, "-o", out, "--error", "-1"},
      {"build", in, "-o", out, "--error", "nan"},
      {"build", in, "-o", out, "--epsilon", "0,2,1x"},
      {"build", in, "-o", out, "--ratio", "0"},
      {"build", in, "-o", out, "--ratio", "1.5"},
      {"build", in, "-o", out, "--ratio", "0.5", "--faces", "20"},
      {"build", in, "-o", out, "--faces", "20", "--levels", "2"},
      {"build", in, "-o", out, "--levels", "0"},
      {"build", in, "-o", out, "--qp", "31"},
      {"build", in, "-o", out, "--metric", "best"},
      {"build", in, "-o", out, "--effort", "0"},
      {"build", in, "-o", out, "--effort", "10"},
      {"build", in, "-o", out, "--report", out},
      {"extract", in, "-o", out},
      {"extract", in, "-o", out, "--faces", "20,10"},
      {"extract", in, "-o", out, "--faces", "20", "--error", "0"},
      {"extract", in, "-o", (folder / "out.stl").string(), "--faces", "20"},
      {"compare", in},
      {"inspect"},
  };
  for (const Names& arguments : wrong) {
    CAPTURE(arguments);
    check_error(run_program(arguments), 1);
  }
  CHECK(names_in(folder.path()) == Names{"sphere.obj"});
}

TEST_CASE("build does not write over its input") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string glb = (folder / "a.glb").string();
  REQUIRE(run_program({"build", in, "-o", glb}).exit_code == 0);
  const std::string before = file_text(glb);
  check_error(run_program({"build", glb, "-o", glb}), 1);
  CHECK(file_text(glb) == before);
}

TEST_CASE("input that cannot be read exits with 2") {
  const ScratchDirectory folder;
  const std::string out = (folder / "out.glb").string();
  const std::string missing = (folder / "missing.obj").string();
  const std::string empty = (folder / "empty.obj").string();
  const std::string junk = (folder / "junk.glb").string();
  write_text(empty, "# nothing\n");
  write_text(junk, "glTF\x02");
  for (const std::string& in : {missing, empty, junk, folder.path().string()}) {
    CAPTURE(in);
    check_error(run_program({"build", in, "-o", out}), 2);
    check_error(run_program({"compare", in, in}), 2);
  }
  check_error(run_program({"extract", junk, "-o", out, "--error", "0"}), 2);
  check_error(run_program({"inspect", missing}), 2);
  check_error(run_program({"inspect", junk}), 2);
  CHECK(names_in(folder.path()) == Names{"empty.obj", "junk.glb"});
}

TEST_CASE("what is not understood exits with 3 and is named") {
  const ScratchDirectory folder;
  const std::string plain = (folder / "plain.gltf").string();
  const std::string odd = (folder / "odd.gltf").string();
  const std::string out = (folder / "out.glb").string();
  write_text(plain, triangle_gltf(""));
  write_text(odd, triangle_gltf(R"(,"extensionsRequired":["EXT_odd_geometry"])"));
  CHECK(run_program({"build", plain, "-o", out}).exit_code == 0);

  const std::string before = file_text(out);
  const ProgramRun run = run_program({"build", odd, "-o", out});
  check_error(run, 3);
  CHECK_THAT(run.err, contains("EXT_odd_geometry"));
  CHECK(file_text(out) == before);

  REQUIRE(run_program({"build", write_sphere(folder).string(), "-o", out}).exit_code == 0);
  const ProgramRun again = run_program({"build", out, "-o", (folder / "again.glb").string()});
  check_error(again, 3);
  CHECK_THAT(again.err, contains("already has levels of detail (MSFT_lod)"));
}

TEST_CASE("extract from a file without a stream exits with 3") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string glb = (folder / "a.glb").string();
  REQUIRE(run_program({"build", in, "-o", glb, "--no-stream"}).exit_code == 0);
  check_error(run_program({"extract", glb, "-o", (folder / "x.obj").string(), "--error", "0"}), 3);
  CHECK(names_in(folder.path()) == Names{"a.glb", "sphere.obj"});
}

TEST_CASE("output that cannot be written exits with 4 and leaves nothing") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string out = (folder / "out.glb").string();
  std::filesystem::create_directory(folder / "folder.glb");
  check_error(run_program({"build", in, "-o", (folder / "no" / "out.glb").string()}), 4);
  check_error(run_program({"build", in, "-o", (folder / "folder.glb").string()}), 4);
  check_error(run_program({"build", in, "-o", out, "--report", (folder / "no" / "r.json").string()}), 4);
  CHECK(names_in(folder.path()) == Names{"folder.glb", "sphere.obj"});
}

TEST_CASE("a folder that takes no files is found out before the work") {
  const ScratchDirectory folder;
  const std::string missing = (folder / "missing.obj").string();
  LODESTONE_SKIP_UNLESS(std::filesystem::exists("/proc/self"), "no folder here that takes no files");
  // The input does not exist either: that it is not what the error names shows what was looked at first.
  for (const Names& arguments : {Names{"build", missing, "-o", "/proc/out.glb"},
                                 Names{"extract", missing, "-o", "/proc/out.glb", "--error", "0"},
                                 Names{"compare", missing, missing, "--html", "/proc/out.html"}}) {
    CAPTURE(arguments);
    const ProgramRun run = run_program(arguments);
    check_error(run, 4);
    CHECK_THAT(run.err, contains("/proc/out."));
  }
}

TEST_CASE("an output that is a symbolic link is written where it leads") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  std::filesystem::create_directory(folder / "store");
  std::filesystem::create_symlink("store/real.glb", folder / "out.glb");
  for (int i = 0; i < 2; ++i) {
    REQUIRE(run_program({"build", in, "-o", (folder / "out.glb").string()}).exit_code == 0);
    CHECK(std::filesystem::is_symlink(folder / "out.glb"));
    CHECK(names_in(folder / "store") == Names{"real.glb"});
  }
}

TEST_CASE("names may be as long as the folder takes, and no longer") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string longest = std::string(251, 'n') + ".glb";
  CHECK(run_program({"build", in, "-o", (folder / longest).string()}).exit_code == 0);
  CHECK(names_in(folder.path()) == Names{longest, "sphere.obj"});
  const ProgramRun run = run_program({"build", "missing", "-o", (folder / ("n" + longest)).string()});
  check_error(run, 4);
  CHECK_THAT(run.err, contains("too long"));
}

TEST_CASE("a report that fails leaves an earlier output as it was") {
  LODESTONE_SKIP_UNLESS(std::filesystem::exists("/dev/full"), "no /dev/full here");
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string out = (folder / "out.glb").string();
  write_text(out, "earlier");
  check_error(run_program({"build", in, "-o", out, "--report", "/dev/full"}), 4);
  CHECK(file_text(out) == "earlier");
  CHECK(names_in(folder.path()) == Names{"out.glb", "sphere.obj"});
}

TEST_CASE("a target that cannot be met is a warning, with --strict exit code 5") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  const std::string out = (folder / "out.glb").string();
  write_text(out, "earlier");
  check_error(run_program({"build", in, "-o", out, "--faces", "1", "--strict"}), 5);
  CHECK(file_text(out) == "earlier");

  const ProgramRun lenient = run_program({"build", in, "-o", out, "--faces", "1"});
  CHECK(lenient.exit_code == 0);
  CHECK_THAT(lenient.err, contains("lodestone: warning: target not met by level 1"));
  CHECK_THAT(lenient.out, contains("stuck"));

  const std::string obj = (folder / "x.obj").string();
  check_error(run_program({"extract", out, "-o", obj, "--faces", "1", "--strict"}), 5);
  CHECK_FALSE(std::filesystem::exists(obj));
  CHECK(run_program({"extract", out, "-o", obj, "--faces", "1"}).exit_code == 0);
  CHECK(names_in(folder.path()) == Names{"out.glb", "sphere.obj", "x.obj"});
}

TEST_CASE("a terminal shows one bar for all the work, and how long the rest may take") {
  const ScratchDirectory folder;
  const std::string in = write_sphere(folder).string();
  std::filesystem::copy(in, folder / "second.obj");
  const Names arguments = {"build", in, (folder / "second.obj").string(), "-o", (folder / "out").string()};
  const std::string shown = shown_on_terminal(arguments);
  const std::regex bar(R"(\[#*\.*\] +([0-9]+)%(, [0-9]+ (s|min|h) left)?, (sphere|second)\.obj, [a-z ]+)");
  std::vector<int> percents;
  bool with_time = false;
  for (std::sregex_iterator found(shown.begin(), shown.end(), bar); found != std::sregex_iterator(); ++found) {
    percents.push_back(std::stoi((*found)[1]));
    with_time |= (*found)[2].matched;
  }
  CAPTURE(shown);
  REQUIRE(percents.size() >= 10);  // five steps of each
  CHECK(with_time);
  CHECK(std::is_sorted(percents.begin(), percents.end()));
  CHECK(percents.front() == 0);
  CHECK(percents.back() > 90);

  Names quiet = arguments;
  quiet.push_back("--quiet");
  CHECK(shown_on_terminal(quiet).empty());
}

TEST_CASE("no file ends the program with a signal or without a message") {
  const ScratchDirectory folder;
  const std::string out = (folder / "out.glb").string();
  for (const char* set : {"nasty", "gltf-invalid", "skin-morph"}) {
    for (const auto& file : mesh_files(set)) {
      CAPTURE(file);
      const ProgramRun build = run_program({"build", file.string(), "-o", out});
      CHECK((build.exit_code == 0 || build.exit_code == 2 || build.exit_code == 3));
      CHECK((build.exit_code == 0) == std::filesystem::exists(out));
      CHECK((build.exit_code == 0) == (build.err.find("error: ") == std::string::npos));
      std::filesystem::remove(out);
      CHECK(run_program({"inspect", file.string()}).exit_code != -1);
      CHECK(names_in(folder.path()).empty());
    }
  }
}

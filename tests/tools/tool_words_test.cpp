// The words that users type: every spelling of a command line that means something does what it means, and what means
// nothing is answered.

#include <algorithm>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/write_mesh.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using Names = std::vector<std::string>;

/// A folder with two small meshes, in which the program runs.
class Workplace {
 public:
  Workplace() : before_(std::filesystem::current_path()) {
    for (const char* name : {"ball.obj", "egg.ply"})
      REQUIRE(write_mesh(folder_ / name, assemble(icosphere(1, 0.02, name[0])).value().mesh));
    std::filesystem::current_path(folder_.path());
  }
  ~Workplace() { std::filesystem::current_path(before_); }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  /// Returns the names of new files, and removes these.
  Names take_new() const {
    Names names = names_in(folder_.path());
    std::erase_if(names, [](const std::string& name) { return name == "ball.obj" || name == "egg.ply"; });
    for (const std::string& name : names) std::filesystem::remove_all(folder_ / name);
    return names;
  }

 private:
  ScratchDirectory folder_;
  std::filesystem::path before_;
};

/// The faces of each level that a command line gives, by its report.
std::vector<std::size_t> faces_of(Names arguments) {
  arguments.insert(arguments.end(), {"--report", "r.json", "-q", "--no-stream", "--no-draco"});
  const ProgramRun run = run_program(arguments);
  CAPTURE(arguments, run.err);
  REQUIRE(run.exit_code == 0);
  std::vector<std::size_t> faces;
  const auto report = nlohmann::json::parse(file_text("r.json"));
  for (const auto& level : report["levels"]) faces.push_back(level["faces"]);
  return faces;
}

/// The largest error in the file's units that was asked for, whether a level was made for it or would repeat another.
double error_of(const Names& words) {
  Names arguments = {"ball.obj", "o.glb", "--report", "r.json", "-q", "--no-stream", "--no-draco", "--error"};
  arguments.insert(arguments.end(), words.begin(), words.end());
  const ProgramRun run = run_program(arguments);
  CAPTURE(arguments, run.err);
  REQUIRE(run.exit_code == 0);
  const auto report = nlohmann::json::parse(file_text("r.json"));
  double largest = 0;
  for (const char* list : {"levels", "left_out"})
    for (const auto& asked : report[list])
      if (!asked["target"].is_null()) largest = std::max(largest, asked["target"]["error"].get<double>());
  return largest;
}

void check_refused(const Names& arguments, const Names& says) {
  const ProgramRun run = run_program(arguments);
  CAPTURE(arguments, run.err);
  CHECK(run.exit_code == 1);
  CHECK(run.out.empty());
  std::size_t at = 0;  // in this order
  for (const std::string& text : says) {
    CAPTURE(text);
    at = run.err.find(text, at);
    REQUIRE(at != std::string::npos);
  }
}

}  // namespace

TEST_CASE("input and output are understood in every order and spelling") {
  const Workplace place;
  for (const Names& arguments : {
           Names{"ball.obj", "out.glb"},
           Names{"ball.obj", "-o", "out.glb"},
           Names{"-o", "out.glb", "ball.obj"},
           Names{"-i", "ball.obj", "-o", "out.glb"},
           Names{"--levels", "2", "ball.obj", "out.glb"},
           Names{"build", "ball.obj", "out.glb"},
           Names{"build", "ball.obj", "-o", "out.glb"},
           Names{"build", "--output", "out.glb", "ball.obj"},
           Names{"build", "-i", "ball.obj", "out.glb"},
           Names{"build", "--input=ball.obj", "--output=out.glb"},
           Names{"build", "-i=ball.obj", "-o=out.glb"},
           Names{"build", "-oout.glb", "ball.obj", "-q"},
           Names{"build", "ball.obj", "--levels=2", "out.glb"},
           Names{"build", "ball.obj", "--weight", "normal=1", "out.glb"},
           Names{"build", "ball.obj", "--ratio", "0.5", "out.glb"},
           Names{"build", "-q", "--", "ball.obj", "out.glb"},
           Names{"-q", "build", "ball.obj", "out.glb"},
           Names{"--levels", "2", "build", "ball.obj", "out.glb"},
           Names{"./ball.obj", "./out.glb"},
       }) {
    CAPTURE(arguments);
    CHECK(run_program(arguments).exit_code == 0);
    CHECK(place.take_new() == Names{"out.glb"});
  }
}

TEST_CASE("a file whose name begins with a dash comes after two of them") {
  const Workplace place;
  std::filesystem::copy("ball.obj", "-odd.obj");
  CHECK(run_program({"build", "-o", "out.glb", "--", "-odd.obj"}).exit_code == 0);
  CHECK(place.take_new() == Names{"-odd.obj", "out.glb"});
}

TEST_CASE("help and version are there under all their names") {
  const std::string version = run_program({"--version"}).out, help = run_program({"--help"}).out;
  for (const char* word : {"-V", "version"}) CHECK(run_program({word}).out == version);
  for (const char* word : {"-h", "help"}) CHECK(run_program({word}).out == help);
  const std::string of_build = run_program({"build", "--help"}).out;
  CHECK_THAT(of_build, contains("--ratio"));
  for (const Names& arguments :
       {Names{"help", "build"}, Names{"build", "help"}, Names{"--help", "build"}, Names{"build", "-h"}}) {
    CAPTURE(arguments);
    CHECK(run_program(arguments).out == of_build);
  }
}

TEST_CASE("ratios are shares or percentages, one for all levels or a list of the whole") {
  const Workplace place;
  const std::vector<std::size_t> halves = {80, 40, 20};
  for (const Names& ratio :
       {Names{"0.5"}, Names{".5"}, Names{"50%"}, Names{"5e-1"}, Names{"50", "%"}, Names{"50 %"}, Names{"+0.5"}}) {
    CAPTURE(ratio);
    Names arguments = {"ball.obj", "o.glb", "--levels", "3", "--ratio"};
    arguments.insert(arguments.end(), ratio.begin(), ratio.end());
    CHECK(faces_of(arguments) == halves);
  }
  const std::vector<std::size_t> shares = {80, 60, 40, 20};
  for (const Names& list : {Names{"0.75,0.5,0.25"}, Names{"75%,50%,25%"}, Names{"0.25, 50%, .75"},
                            Names{"0.75", "0.5", "0.25"}, Names{"0.75,", "0.5,", "0.25"},
                            Names{"75 %", "50 %", "25", "%"}, Names{"75% .5 25%"}, Names{"0.75", ",0.5", ",0.25"}}) {
    CAPTURE(list);
    Names arguments = {"--ratio"};
    arguments.insert(arguments.end(), list.begin(), list.end());
    arguments.insert(arguments.end(), {"ball.obj", "o.glb"});
    CHECK(faces_of(arguments) == shares);
  }
  CHECK(faces_of({"ball.obj", "o.glb", "--ratio", "0.75,", "50%", "0.25"}) == shares);
  CHECK(faces_of({"ball.obj", "o.glb", "--ratio", "0.75", "--ratio", "0.5,0.25"}) == shares);
  CHECK(faces_of({"ball.obj", "o.glb", "--faces", "60", "40", "--faces=20"}) == shares);
}

TEST_CASE("other lists may be several words, too") {
  const Workplace place;
  const auto settings_of = [](const Names& words) {
    Names arguments = {"build", "ball.obj", "o.glb", "--report", "r.json", "-q", "--levels", "1", "--no-stream"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    REQUIRE(run_program(arguments).exit_code == 0);
    return nlohmann::json::parse(file_text("r.json"))["settings"];
  };
  for (const Names& origin : {Names{"1,-2,0"}, Names{"1", "-2", "0"}, Names{"1,", "-2,", "0"}}) {
    Names words = {"--grid-step", "0.01", "--grid-origin"};
    words.insert(words.end(), origin.begin(), origin.end());
    CHECK(settings_of(words)["position_grid"]["origin"] == nlohmann::json({1, -2, 0}));
  }
  const auto weights = settings_of({"--weight", "normal=1,", "texcoord=2", "--weight", "skin=4"})["weights"];
  CHECK(weights["normal"] == 1);
  CHECK(weights["texcoord"] == 2);
  CHECK(weights["skin"] == 4);
}

TEST_CASE("an error is a percentage, pixels of a screen, a length, or a number in the file's units") {
  const Workplace place;
  const double diagonal = bounding_box(read_mesh("ball.obj").value().mesh).diagonal();
  const auto of_diagonal = [&](double share) { return Approx(diagonal * share).epsilon(1e-9); };
  CHECK(error_of({"0.5%"}) == of_diagonal(0.005));
  CHECK(error_of({".5 %"}) == of_diagonal(0.005));
  CHECK(error_of({"0.5", "%"}) == of_diagonal(0.005));
  // The height of the screen, filled by the diagonal.
  CHECK(error_of({"1px@1080p"}) == of_diagonal(1.0 / 1080));
  CHECK(error_of({"2px@1080"}) == of_diagonal(2.0 / 1080));
  CHECK(error_of({"1", "px@720p"}) == of_diagonal(1.0 / 720));
  CHECK(error_of({"1px @ 2160p"}) == of_diagonal(1.0 / 2160));
  CHECK(error_of({"1px@1920x1080"}) == of_diagonal(1.0 / 1080));
  CHECK(error_of({"0.5px"}) == of_diagonal(0.5 / 1080));
  CHECK(error_of({"1px@4k"}) == of_diagonal(1.0 / 2160));
  CHECK(error_of({"1mm"}) == Approx(0.001));
  CHECK(error_of({"1", "mm"}) == Approx(0.001));
  CHECK(error_of({"1cm"}) == Approx(0.01));
  CHECK(error_of({"0.1m"}) == Approx(0.1));
  CHECK(error_of({"1in"}) == Approx(0.0254));
  CHECK(error_of({"0.1"}) == Approx(0.1));
  CHECK(error_of({"0.1%,0.2%,", "0.5%"}) == of_diagonal(0.005));
  for (const char* wrong : {"1px@", "1px@0", "1px@big", "1parsec", "mm", "%", "1%%", "0.1%,", "-1mm", ""}) {
    CAPTURE(wrong);
    check_refused({"ball.obj", "o.glb", "--error", wrong}, {"--error", "is not an error"});
  }
}

TEST_CASE("an error that may not mean what it says is warned of") {
  const Workplace place;
  const auto warning = [](const std::string& in, const std::string& error) {
    const ProgramRun run = run_program({"build", in, "o.glb", "--error", error, "-q"});
    CHECK(run.exit_code == 0);
    return run.err;
  };
  // The diagonal is about 3.46.
  CHECK_THAT(warning("ball.obj", "0.1"),
             contains("warning") && contains("2.") && contains("% of the diagonal") && contains("write 0.1%"));
  CHECK_THAT(warning("ball.obj", "0.001,0.1"), contains("--error 0.1 is in the file's units"));
  CHECK(warning("ball.obj", "0.03").empty());
  CHECK(warning("ball.obj", "5%").empty());
  CHECK_THAT(warning("ball.obj", "1mm"), contains("does not say what its unit is") && contains("metre"));
  REQUIRE(write_mesh("ball.glb", read_mesh("ball.obj").value().mesh));
  CHECK(warning("ball.glb", "1mm").empty());
  REQUIRE(run_program({"ball.obj", "lod.glb"}).exit_code == 0);
  CHECK_THAT(run_program({"extract", "lod.glb", "x.obj", "--error", "0.1"}).err, contains("is in the file's units"));
}

TEST_CASE("unknown options are all named, in the order typed, with what may be meant") {
  const Workplace place;
  check_refused({"build", "--rati", "0.5", "ball.obj", "--zzz", "o.glb", "--Strict"},
                {"'--rati' (did you mean --ratio?)", "'--zzz',", "'--Strict' (did you mean --strict?)",
                 "lodestone build --help"});
  check_refused({"build", "ball.obj", "o.glb", "--no-darco"}, {"did you mean --no-draco?"});
  check_refused({"build", "ball.obj", "-output", "o.glb"}, {"'-output' (did you mean --output?)"});
  check_refused({"build", "ball.obj", "o.glb", "--rati=0.5"}, {"'--rati' (did you mean --ratio?)"});
  check_refused({"extract", "ball.obj", "o.glb", "--levels", "2"}, {"did you mean --level?"});
  check_refused({"inspect", "ball.obj", "--jason"}, {"did you mean --json?"});
  check_refused({"compare", "ball.obj", "egg.ply", "--sampels", "5000"}, {"did you mean --samples?"});
  check_refused({"biuld", "ball.obj", "o.glb"}, {"'biuld' is neither a command nor a file (did you mean build?)"});
  check_refused({"help", "extrct"}, {"did you mean extract?"});
  CHECK(place.take_new().empty());
}

TEST_CASE("what other programs call it is answered with our word") {
  const Workplace place;
  check_refused({"-i", "ball.obj", "-o", "o.glb", "-si", "0.5", "-se", "0.01", "-cc"},
                {"'-si'", "--ratio", "'-se'", "--error", "'-cc'", "--compress meshopt"});
  check_refused({"build", "ball.obj", "o.glb", "-slb", "-noq", "-vp", "12", "-kn"},
                {"--lock-border", "--compress none", "--qp", "stay"});
  check_refused({"decimate", "ball.obj", "o.glb", "--ratio", "0.5"}, {"'decimate'", "is simplify here"});
  check_refused({"optimize", "ball.obj", "o.glb"}, {"is build here"});
  check_refused({"build", "ball.obj", "o.glb", "--simplify-error", "0.001", "--compress", "draco"}, {"--error"});
  check_refused({"build", "ball.obj", "o.glb", "--draco"}, {"--compress"});
  check_refused({"build", "ball.obj", "o.glb", "--triangles", "40"}, {"--faces N"});
}

TEST_CASE("values that are missing, doubled or out of range are named") {
  const Workplace place;
  check_refused({"build", "ball.obj", "-o"}, {"-o needs a value"});
  check_refused({"build", "ball.obj", "o.glb", "--ratio", "--quiet"}, {"--ratio needs a value"});
  check_refused({"build", "ball.obj", "-o", "o.glb", "-o", "p.glb"}, {"-o is given twice"});
  check_refused({"build", "ball.obj", "o.glb", "--ratio", "50"}, {"'50' is not a share", "did you mean 50%?"});
  check_refused({"build", "ball.obj", "o.glb", "--faces", "50%"}, {"--ratio"});
  check_refused({"build", "ball.obj", "o.glb", "--ratio", "0.5,,0.25"}, {"''"});
  check_refused({"build", "ball.obj", "o.glb", "--ratio", "0.5,0.25", "--levels", "3"},
                {"--levels goes with one --ratio"});
  check_refused({"build", "ball.obj"}, {"no output is given", "-o OUT"});
  check_refused({"build"}, {"no input is given"});
  check_refused({"build", "ball.obj", "out"}, {"does not end in .glb, .gltf or .lods", "out.glb", "out/"});
  check_refused({"build", "ball.obj", "new.glb", "-o", "o.glb"}, {"2 inputs", "'o.glb'", "'new.glb' does not exist"});
  check_refused({"extract", "ball.obj", "o.glb"}, {"give one value", "--level"});
  check_refused({"extract", "ball.obj", "o.glb", "--level", "1", "--faces", "9"}, {"give one value"});
  CHECK(place.take_new().empty());
}

}  // namespace lodestone::test

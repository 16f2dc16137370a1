#include "build_command.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>

#include "build_output.h"
#include "build_run.h"
#include "interruption.h"
#include "messages.h"
#include "staged_file.h"
#include "standard_streams.h"

namespace lodestone::tool {
namespace {

using detail::text;

constexpr int kMaxLevelCount = 32, kMaxThreadCount = 1024;
constexpr std::array<std::string_view, 3> kFormats = {"glb", "gltf", "lods"};
constexpr const char* kFileGroup = "File";  // a heading of the help

/// Places a file beside the output, in a folder that is made where it does not exist.
Result<void> place_beside(std::optional<std::filesystem::path>& file, const std::filesystem::path& input,
                          const std::string& extension, bool several, MadeFolders& folders) {
  if (!file) return {};
  const std::filesystem::path placed = place_in(*file, input, extension, several);
  if (placed != *file) {
    LODESTONE_CHECK(folders.make(placed.parent_path()));
  } else if (several) {
    return fail(ErrorCode::InvalidArgument, quoted(*file) + " is one file for several inputs: name a folder");
  }
  file = placed;
  return {};
}

bool writes_to_standard_output(const BuildCommand& options) {
  return is_standard_stream(options.output) || (options.report && is_standard_stream(*options.report)) ||
         (options.html && is_standard_stream(*options.html));
}

Result<Outcome> build_one(const BuildCommand& options, ProgressBar& progress) {
  const Result<FinishedBuild> result = run_build(options, progress);
  progress.clear();
  if (!result) return tl::unexpected(result.error());
  if (result->outcome != Outcome::Done) return result->outcome;
  for (const std::string& line : leftover_levels(options, result->report)) print_warning(line);
  if (!options.quiet && !writes_to_standard_output(options)) print_table(result->report);
  return result->outcome;
}

/// How much of the whole work each part is, as far as the sizes of the inputs tell.
std::vector<double> expected_work(const std::vector<BuildCommand>& parts) {
  constexpr double kLeast = 1000;
  std::vector<double> work;
  for (const BuildCommand& part : parts) {
    std::error_code unknown;
    const auto bytes = static_cast<double>(std::filesystem::file_size(part.input, unknown));
    work.push_back(unknown ? kLeast : std::max(bytes, kLeast));
  }
  return work;
}

/// Builds one after the other; what is wrong with one does not keep the others.
Result<Outcome> build_each(const std::vector<BuildCommand>& parts, ProgressBar& progress) {
  const std::vector<double> work = expected_work(parts);
  const double whole = std::accumulate(work.begin(), work.end(), 0.0);
  std::optional<ErrorCode> first_error;
  std::size_t failed = 0;
  Outcome outcome = Outcome::Done;
  double done = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    progress.start_piece(parts[i].input.filename().string() + ", ", done / whole, (done + work[i]) / whole);
    done += work[i];
    Result<Outcome> result = build_one(parts[i], progress);
    if (result && *result != Outcome::Done) outcome = *result;
    if (result) continue;
    if (result.error().code == ErrorCode::Cancelled) return result;
    print_error(quoted(parts[i].input) + " is not built: " + describe(result.error()));
    if (!first_error) first_error = result.error().code;
    ++failed;
  }
  if (!first_error) return outcome;
  return fail(*first_error, text(failed, " of ", parts.size(), " inputs are not built"));
}

}  // namespace

void BuildCommand::add_to(CLI::App& app) {
  files.add_to(
      app, "Scene or mesh file: glTF, GLB, OBJ, PLY, STL and others; - for standard input",
      "The .glb or .gltf to write, or a .lods, the stream alone; a folder, for several inputs; - for standard output");
  add_format_option(app, format, kFormats);
  add_run_options(app);
  add_level_options(app);
  add_control_options(app);
  add_metric_options(app);
  add_profile_options(app);
  add_storage_options(app);
  app.footer(
      "Examples:\n"
      "  lodestone build bunny.obj bunny.glb\n"
      "  lodestone build bunny.obj -o bunny.glb --error 0.1%,0.5%,2% --report bunny.json\n"
      "  lodestone build bunny.obj -o bunny.glb --faces 20000,2000 --compress meshopt\n"
      "  lodestone build bunny.obj -o bunny.glb --html bunny.html\n"
      "  lodestone build town.gltf -o town.glb --profile files\n"
      "  lodestone build bunny.obj -o bunny.lods --qp 12\n"
      "  lodestone build bunny.obj -o bunny.glb --profile stream\n"
      "  lodestone build *.obj -o lods/");
}

void SimplifyCommand::add_to(CLI::App& app) {
  files.add_to(app, "Scene or mesh file: glTF, GLB, OBJ, PLY, STL and others; - for standard input",
               "The .glb, .gltf, .obj or .ply to write; a folder, for several inputs; - for standard output");
  add_format_option(app, format, kLevelFormats);
  add_run_options(app);
  const char* group = "How far: one of these";
  targets.add_to(app, group, false, true);
  app.add_flag("--per-mesh", per_mesh, "The target is for each mesh; otherwise the whole scene shares it")
      ->group(group);
  add_control_options(app);
  add_metric_options(app);
  add_storage_options(app);
  app.footer(
      "Examples:\n"
      "  lodestone simplify town.gltf town-small.glb --ratio 25%\n"
      "  lodestone simplify bunny.ply bunny-5k.ply --faces 5000\n"
      "  lodestone simplify part.stl part.glb --error 0.1mm --compress none\n"
      "  lodestone simplify *.obj -o small/ --format obj --error 0.1%");
}

void BuildCommand::add_run_options(CLI::App& app) {
  app.add_option("--input-format", input_format,
                 "What standard input is, as an extension (default: as its content says)")
      ->type_name("NAME");
  app.add_option("--report", report, "Write a JSON report")->type_name("R.json");
  app.add_option("--html", html, "Write a page that shows the levels, their errors and where these are")
      ->type_name("P.html");
  app.add_option("--effort", effort,
                 "How much work the result is worth: 1 is the fastest, a draft whose bounds are less tight; 9 the best "
                 "(default 5)")
      ->check(CLI::Range(kLeastEffort, kMostEffort))
      ->type_name("N");
  app.add_option("--threads", thread_count, "Use at most so many threads (default: all cores); the result is the same")
      ->check(CLI::Range(1, kMaxThreadCount))
      ->type_name("N");
  app.add_flag("--strict", strict, "Write nothing and exit with 5 where a target cannot be met");
  app.add_flag("-q,--quiet", quiet, "Print warnings and errors only");
}

void BuildCommand::add_level_options(CLI::App& app) {
  const char* group = "Levels: by ratio, or a list with one entry for each level after the whole mesh";
  app.add_option("--levels", level_count, "Levels, the whole mesh included (default 5)")
      ->check(CLI::Range(1, kMaxLevelCount))
      ->type_name("N")
      ->group(group);
  targets.add_to(app, group, true, true);
  app.add_flag("--per-mesh", per_mesh, "Targets are for each mesh; otherwise the whole scene shares them")
      ->group(group);
}

void BuildCommand::add_control_options(CLI::App& app) {
  const char* group = "What to keep";
  app.add_flag("--lock-border", lock_border, "Keep every vertex of an open border")->group(group);
  app.add_option("--crease-angle", crease_angle, "Keep edges between faces that turn by more than this, in degrees")
      ->check(CLI::Range(0.0, 180.0))
      ->type_name("DEG")
      ->group(group);
  app.add_option("--weight", weights,
                 "How much differences of an attribute count: normal=0.25, texcoord=1, color=0.5, skin=3, target=3")
      ->type_name("NAME=FACTOR")
      ->allow_extra_args(false)
      ->delimiter(',')
      ->group(group);
  app.add_option(
         "--importance", importance,
         "The vertex attribute that says how important a vertex is (default _LODESTONE_IMPORTANCE): a factor, "
         "from 1000 on the vertex stays; a COLOR_n counts 1/16 where black, 16 where bright, and stays where white")
      ->type_name("NAME")
      ->group(group);
  app.add_option("--settings", settings, "Importance and locks of materials and nodes, by name; see docs/program.md")
      ->type_name("S.json")
      ->group(group);
  app.add_flag("--vanish", vanish, "Let even the last piece of a mesh vanish where the target asks for it")
      ->group(group);
}

void BuildCommand::add_metric_options(CLI::App& app) {
  const char* group = "Metric";
  app.add_option("--metric", metric, "What a removal is charged for (default hybrid)")
      ->check(CLI::IsMember({"hybrid", "gaussian", "mean", "principal"}))
      ->type_name("NAME")
      ->group(group);
  app.add_option("--normalise,--normalize", normalisation, "Curvature over a vertex's area share, or divided by it")
      ->check(CLI::IsMember({"integral", "density"}))
      ->type_name("NAME")
      ->group(group);
  app.add_option("--reference", reference, "The surface whose curvature a removal is compared with")
      ->check(CLI::IsMember({"original", "current"}))
      ->type_name("NAME")
      ->group(group);
}

void BuildCommand::add_profile_options(CLI::App& app) {
  app.add_option(
         "--profile", profile,
         "One file, levels by MSFT_lod (default); a file for each level and an index; or one file of a coarse "
         "level (3 % of the faces, fewer for a first picture within 4 kB or a hundredth of the file; or one "
         "target) and a stream that refines it to the whole, together about as large as the whole mesh by Draco")
      ->check(CLI::IsMember({"msft-lod", "files", "stream"}))
      ->type_name("NAME")
      ->group(kFileGroup);
  CLI::Option* none = app.add_flag("--no-stream", no_stream, "Leave the removal stream out")->group(kFileGroup);
  app.add_flag("--lossless", lossless,
               "Keep the stream's numbers bit for bit, at two to four times its size, instead of rounding them as "
               "compressed levels do")
      ->excludes(none)
      ->group(kFileGroup);
  app.add_option(
         "--stream-coding", stream_coding,
         "How the stream's bits are coded: small, in the fewest bytes (default), or fast, decoded in two fifths of "
         "the time at 3 to 6 % more bytes (default at --effort 1 and 2)")
      ->check(CLI::IsMember({"small", "fast"}))
      ->type_name("NAME")
      ->excludes(none)
      ->group(kFileGroup);
}

void BuildCommand::add_storage_options(CLI::App& app) {
  app.add_option(
         "--placement", placement,
         "Where a level's vertices lie: fitted to the original (default; skinned and morphed meshes are left out), "
         "or a subset of its vertices, as in the stream")
      ->check(CLI::IsMember({"optimised", "subset"}))
      ->type_name("NAME")
      ->group(kFileGroup);
  CLI::Option* compress =
      app.add_option(
             "--compress", compression,
             "By Draco, smallest (default); by meshopt, decoded faster, which three.js and Babylon.js read too; "
             "or not at all, for viewers without a decoder")
          ->check(CLI::IsMember({"draco", "meshopt", "none"}))
          ->type_name("NAME")
          ->group(kFileGroup);
  app.add_flag_callback(
         "--no-draco", [this] { compression = "none"; }, "The same as --compress none")
      ->excludes(compress)
      ->group(kFileGroup);
  CLI::Option* bits =
      app.add_option("--qp", position_bits,
                     "Bits of a position (default 14, more where the shape needs them); of compact streams 8 to 16")
          ->check(CLI::Range(1, 30))
          ->type_name("BITS")
          ->group(kFileGroup);
  CLI::Option* step =
      app.add_option("--grid-step", grid_step,
                     "Round positions to multiples of this, in the meshes' own units, instead of a "
                     "grid fitted to the file: tiles built one by one with --lock-border then fit together")
          ->check(CLI::PositiveNumber)
          ->type_name("STEP")
          ->excludes(bits)
          ->group(kFileGroup);
  app.add_option("--grid-origin", grid_origin, "Where multiples of --grid-step count from (default 0,0,0)")
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,Z")
      ->needs(step)
      ->group(kFileGroup);
}

/// Returns a command for each input, its files named; makes the folders that they go into.
Result<std::vector<BuildCommand>> BuildCommand::split(MadeFolders& folders) const {
  LODESTONE_TRY(const std::vector<FilePair> pairs, files.pair_up("." + format));
  const bool several = pairs.size() > 1;
  std::vector<BuildCommand> parts(pairs.size(), *this);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const FilePair& pair = pairs[i];
    BuildCommand& part = parts[i];
    part.input = pair.input;
    part.output = pair.output;
    Result<void> done;
    if (pair.in_folder) done = folders.make(pair.output.parent_path());
    if (done) done = place_beside(part.report, part.input, ".json", several, folders);
    if (done) done = place_beside(part.html, part.input, ".html", several, folders);
    if (!done) return tl::unexpected(done.error());
  }
  return parts;
}

Result<Outcome> BuildCommand::run() const {
  if (!input_format.empty() && !files.reads_standard_input())
    return fail(ErrorCode::InvalidArgument, "--input-format is for the standard input: give - as the input");
  const Interruption interruption;
  MadeFolders folders;
  LODESTONE_TRY(const std::vector<BuildCommand> parts, split(folders));
  ProgressBar progress(!quiet);
  Result<Outcome> outcome = Outcome::Done;
  with_threads(thread_count,
               [&] { outcome = parts.size() == 1 ? build_one(parts.front(), progress) : build_each(parts, progress); });
  return outcome;
}

}  // namespace lodestone::tool

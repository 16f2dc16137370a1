#include "build_command.h"

#include <CLI/CLI.hpp>

#include "build_run.h"

namespace lodestone::tool {
namespace {

constexpr int kMaxLevelCount = 32;

}  // namespace

void BuildCommand::add_to(CLI::App& app) {
  app.add_option("-i,--input,IN", input, "Scene or mesh file: glTF, GLB, OBJ, PLY, STL and others")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", output, "The .glb to write")->required()->type_name("OUT.glb");
  app.add_option("--report", report, "Write a JSON report")->type_name("R.json");
  app.add_option("--html", html, "Write a page that shows the levels, their errors and where these are")
      ->type_name("P.html");
  app.add_flag("--strict", strict, "Write nothing and exit with 5 where a target cannot be met");
  app.add_flag("-q,--quiet", quiet, "Print warnings and errors only");
  add_level_options(app);
  add_control_options(app);
  add_metric_options(app);
  add_format_options(app);
  app.footer(
      "Examples:\n"
      "  lodestone build bunny.obj -o bunny.glb\n"
      "  lodestone build bunny.obj -o bunny.glb --error 0.1%,0.5%,2% --report bunny.json\n"
      "  lodestone build bunny.obj -o bunny.glb --faces 20000,2000 --no-draco\n"
      "  lodestone build bunny.obj -o bunny.glb --html bunny.html\n"
      "  lodestone build town.gltf -o town.glb --profile files");
}

void BuildCommand::add_level_options(CLI::App& app) {
  const char* group = "Levels: by ratio, or a list with one entry for each level after the whole mesh";
  app.add_option("--levels", level_count, "Levels, the whole mesh included (default 5)")
      ->check(CLI::Range(1, kMaxLevelCount))
      ->type_name("N")
      ->group(group);
  targets.add_to(app, group, true);
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
      ->delimiter(',')
      ->group(group);
  app.add_option("--importance", importance,
                 "The vertex attribute that says how important a vertex is (default _LODESTONE_IMPORTANCE): a factor, "
                 "from 1000 on the vertex stays; a COLOR_n counts 1/16 where black, 16 where bright, and stays where white")
      ->type_name("NAME")
      ->group(group);
  app.add_option("--settings", settings, "Importance and locks of materials and nodes, by name; see the README")
      ->type_name("S.json")
      ->group(group);
  app.add_flag("--vanish", vanish, "Let even the last piece of a mesh vanish where the target asks for it")->group(group);
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

void BuildCommand::add_format_options(CLI::App& app) {
  const char* group = "File";
  app.add_option("--placement", placement,
                 "Where a level's vertices lie: fitted to the original (default; skinned and morphed meshes are left out), "
                 "or a subset of its vertices, as in the stream")
      ->check(CLI::IsMember({"optimised", "subset"}))
      ->type_name("NAME")
      ->group(group);
  app.add_option("--profile", profile, "One file, levels by MSFT_lod (default), or a file for each level and an index")
      ->check(CLI::IsMember({"msft-lod", "files"}))
      ->type_name("NAME")
      ->group(group);
  app.add_flag("--no-stream", no_stream, "Leave the removal stream out")->group(group);
  app.add_flag("--no-draco", no_draco, "Write plain geometry that needs no decoder")->group(group);
  CLI::Option* bits = app.add_option("--qp", position_bits, "Bits of a Draco position (default 14, more where the shape needs them)")
                          ->check(CLI::Range(1, 30))
                          ->type_name("BITS")
                          ->group(group);
  CLI::Option* step = app.add_option("--grid-step", grid_step,
                                     "Round Draco positions to multiples of this, in the meshes' own units, instead of a "
                                     "grid fitted to the file: tiles built one by one with --lock-border then fit together")
                          ->check(CLI::PositiveNumber)
                          ->type_name("STEP")
                          ->excludes(bits)
                          ->group(group);
  app.add_option("--grid-origin", grid_origin, "Where multiples of --grid-step count from (default 0,0,0)")
      ->expected(3)
      ->delimiter(',')
      ->type_name("X,Y,Z")
      ->needs(step)
      ->group(group);
}

Result<Outcome> BuildCommand::run() const { return run_build(*this); }

}  // namespace lodestone::tool

#include "build_run.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/detail/cancelled.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/scene.h>
#include <lodestone/pipeline/build_asset.h>

#include "build_html.h"
#include "build_options.h"
#include "build_output.h"
#include "build_settings.h"
#include "file_words.h"
#include "input_files.h"
#include "interruption.h"
#include "messages.h"
#include "pipeline/stopwatch.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

using detail::text;

/// About what share of the time each stage takes; together 1.
constexpr double kReadingShare = 0.01;
struct StageLook {
  BuildStage stage;
  const char* name;
  double share;
};
constexpr std::array kStages = {
    StageLook{BuildStage::Simplifying, "simplifying", 0.12}, StageLook{BuildStage::MakingLevels, "making levels", 0.5},
    StageLook{BuildStage::MeasuringLevels, "measuring levels", 0.33}, StageLook{BuildStage::Writing, "writing", 0.04}};

/// Shows a build on the terminal.
class BarObserver : public BuildObserver {
 public:
  explicit BarObserver(ProgressBar& bar) : bar_(bar) {}

  bool progress(BuildStage stage, double done) override {
    const char* name = "";
    double overall = kReadingShare;
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      if (kStages[i].stage == stage) done_[i] = done, name = kStages[i].name;
      overall += kStages[i].share * done_[i];
    }
    bar_.update(name, overall);
    return !Interruption::is_wanted();
  }

  void note(const std::string& sentence) override {
    bar_.clear();
    print_warning(sentence);
  }

 private:
  ProgressBar& bar_;
  std::array<double, kStages.size()> done_{};
};

AssemblyReport assembly_of(const Scene& scene) {
  AssemblyReport total;
  for (const SceneMesh& mesh : scene.meshes()) total = total + mesh.assembly;
  for (const AssemblyReport& dropped : scene.dropped()) total = total + dropped;
  return total;
}

std::vector<std::string> remarks(const Scene& scene) {
  std::vector<std::string> lines = scene.notes();
  for (std::string& line : sentences(assembly_of(scene))) lines.push_back(std::move(line));
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "; ") + line;
  return text;
}

Result<void> check_input(const std::filesystem::path& path, const Scene& scene) {
  if (!scene.meshes().empty()) return {};
  const std::string why = joined(remarks(scene));
  return fail(ErrorCode::Malformed, quoted(path) + ": no triangles to simplify" + (why.empty() ? "" : ": " + why));
}

BuildReport::Input input_report(const std::filesystem::path& path, const Scene& scene) {
  BuildReport::Input input{path.string(), 0, 0, scene.box(), 0, assembly_of(scene), scene.notes(), scene.files()};
  for (const SceneMesh& mesh : scene.meshes()) {
    input.area += mesh.area;
    input.face_count += mesh.mesh.face_count() * mesh.instance_count;
    input.vertex_count += mesh.mesh.vertex_count() * mesh.instance_count;
  }
  return input;
}

void append_item(std::string& list, const std::string& item) { list += (list.empty() ? "" : ", ") + item; }

/// Why the base mesh's vertices stay.
std::string blocked_text(const BlockedCounts& blocked) {
  std::string items;
  if (blocked.locked > 0) append_item(items, text(blocked.locked, " are locked"));
  if (blocked.flip > 0) append_item(items, text(blocked.flip, " would turn a face over"));
  if (blocked.link > 0) append_item(items, text(blocked.link, " would double an edge"));
  if (blocked.shape > 0) append_item(items, text(blocked.shape, " would leave a sliver"));
  if (blocked.texture > 0) append_item(items, text(blocked.texture, " would turn a texture over"));
  if (blocked.error > 0) append_item(items, text(blocked.error, " beyond the error allowed"));
  if (blocked.ring > 0) append_item(items, text(blocked.ring, " have too many neighbours"));
  return "vertices left: " + (items.empty() ? "none" : items);
}

/// What was asked for.
std::string target_text(const LevelTarget& target) {
  return target.relative ? percent_text(target.value, 1) + " of the" : number_text(target.value, 15);
}

/// `faces` are left, where fewer would have been off by up to `beyond`, or there are none.
std::string missed_faces(const BuildReport& report, const BuildCommand& options, const std::string& targets,
                         const std::string& faces, double beyond) {
  const std::string why = beyond > 0
                              ? "fewer would be up to " + percent_text(beyond, report.input.box.diagonal()) + " off"
                              : "there are no fewer; " + blocked_text(report.build.stream.blocked);
  return targets + " faces were asked for" + (options.per_mesh ? " of each mesh, " : ", ") + faces +
         " are left: " + why;
}

/// Only quantisation is in the way of an error: the whole mesh has none.
std::string missed_errors(const BuildReport& report, const std::string& targets) {
  return "errors of " + targets + " were asked for, the grid of positions alone moves vertices by " +
         number_text(report.build.grid_error);
}

/// Which levels have more faces or larger errors than asked for, and why. Pre: there are any.
std::string missed_targets(const BuildReport& report, const BuildCommand& options) {
  std::string levels, targets, faces;
  double beyond = 0;
  std::optional<TargetKind> kind;
  for (std::size_t i = 0; i < report.build.levels.size(); ++i) {
    std::string missed, last;
    const auto miss = [&](const LevelTarget& target, double deviation_beyond) {
      if (const std::string text = target_text(target); text != last) append_item(missed, last = text);
      beyond = std::max(beyond, deviation_beyond);
      kind = target.kind;
    };
    const BuildResult::Level& level = report.build.levels[i];
    if (!level.met) miss(*level.target, level.deviation_beyond);
    for (const BuildResult::LeftOut& left_out : report.build.left_out)
      if (!left_out.met && left_out.level == i) miss(left_out.target, left_out.deviation_beyond);
    if (missed.empty()) continue;
    append_item(levels, std::to_string(i));
    append_item(targets, missed);
    append_item(faces, std::to_string(level.face_count));
  }
  return "target not met by level " + levels + ": " +
         (kind == TargetKind::Error ? missed_errors(report, targets)
                                    : missed_faces(report, options, targets, faces, beyond));
}

/// Reads all triangles of the input as one mesh; `materials` are their materials' numbers, by primitive.
Result<Scene> read_as_one_mesh(const BuildCommand& options, std::vector<Index>& materials) {
  LODESTONE_TRY(MeshFile file, read_mesh_file(options.input, options.input_format));
  std::set<Index> numbers(file.mesh.face_material.begin(), file.mesh.face_material.end());
  materials.assign(numbers.begin(), numbers.end());
  return Scene::from_mesh(std::move(file), options.input.stem().string());
}

/// Reads the input and says what is otherwise in it than one would think.
Result<Scene> read_input(const BuildCommand& options, std::vector<Index>& materials, BuildReport& report,
                         ProgressBar& bar) {
  bar.update("reading", 0);
  detail::Stopwatch stopwatch;
  Result<Scene> scene = writes_stream_file(options) ? read_as_one_mesh(options, materials)
                                                    : read_scene(options.input, options.input_format);
  bar.clear();
  if (!scene) return scene;
  LODESTONE_CHECK(check_input(options.input, *scene));
  report.input = input_report(options.input, *scene);
  std::vector<std::string> lines = remarks(*scene);
  for (std::string& line : options.targets.remarks(scene->box().diagonal(), scene->in_metres()))
    lines.push_back(std::move(line));
  for (const std::string& line : lines) print_warning(quoted(options.input) + ": " + line);
  report.reading_ms = stopwatch.lap_ms();
  return scene;
}

Result<void> write(const BuildCommand& options, const Scene& scene, BuildReport& report) {
  report.output_path = options.output.string();
  if (writes_mesh_file(options)) LODESTONE_CHECK(make_mesh_file(options, scene, report));
  list_files(options, report);
  std::string page;
  if (options.html) {
    LODESTONE_TRY(page, build_page(report, scene, writes_stream(options)));
  }
  if (Interruption::is_wanted()) return detail::cancelled();
  return write_outputs(options, report, page);
}

}  // namespace

Result<FinishedBuild> run_build(const BuildCommand& command, ProgressBar& bar) {
  FinishedBuild finished;
  BuildReport& report = finished.report;
  LODESTONE_TRY(BuildOptions options, build_options(command));
  const std::size_t level_count = options.targets.size() + 1;
  LODESTONE_CHECK(check_paths(command, level_count));
  report.settings = settings_json(command, options);

  LODESTONE_TRY(const Scene scene, read_input(command, options.material_numbers, report, bar));
  BarObserver observer(bar);
  Result<BuildResult> built = build_asset(scene, options, observer);
  bar.clear();
  if (!built) return tl::unexpected(built.error());
  report.build = std::move(*built);

  if (!report.build.met) {
    const std::string message = missed_targets(report, command);
    command.strict ? print_error(message) : print_warning(message);
    if (command.strict) finished.outcome = Outcome::TargetNotMet;
  }
  if (finished.outcome != Outcome::Done) return finished;
  LODESTONE_CHECK(write(command, scene, report));
  return finished;
}

}  // namespace lodestone::tool

#include "build_run.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include <lodestone/io/scene.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>

#include "build_html.h"
#include "build_options.h"
#include "build_output.h"
#include "build_report.h"
#include "build_settings.h"
#include "file_words.h"
#include "input_files.h"
#include "messages.h"
#include "parallel.h"
#include "scene_target.h"
#include "scene_totals.h"
#include "stopwatch.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr double kMostFacesOfOneRemoval = 2;
constexpr double kQuantisationShare = 0.1;  // of an error that a level may have
constexpr double kBoxGrowth = 1.05;         // fitted vertices may lie a little outside of the box that grids span

/// About what share of the time each step takes; together 1.
constexpr double kReadingShare = 0.01, kSimplifyingShare = 0.12, kMakingShare = 0.5, kMeasuringShare = 0.33,
                 kWritingShare = 0.04;

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
  std::string text;
  if (blocked.locked > 0) append_item(text, std::to_string(blocked.locked) + " are locked");
  if (blocked.flip > 0) append_item(text, std::to_string(blocked.flip) + " would turn a face over");
  if (blocked.link > 0) append_item(text, std::to_string(blocked.link) + " would double an edge");
  if (blocked.shape > 0) append_item(text, std::to_string(blocked.shape) + " would leave a sliver");
  if (blocked.texture > 0) append_item(text, std::to_string(blocked.texture) + " would turn a texture over");
  if (blocked.error > 0) append_item(text, std::to_string(blocked.error) + " beyond the error allowed");
  if (blocked.ring > 0) append_item(text, std::to_string(blocked.ring) + " have too many neighbours");
  return "vertices left: " + (text.empty() ? "none" : text);
}

/// What was asked for.
std::string target_text(const LevelTarget& target) {
  return target.relative ? percent_text(target.value, 1) + " of the" : number_text(target.value, 15);
}

// Two digits for a table and a report, in a fraction of the time that `compare` takes for its four.
constexpr double kSceneSamples = 50'000;           // Each way, for a level of all meshes together.
constexpr double kSceneAttributeSamples = 20'000;  // The same for attributes.
constexpr double kLeastShare = 0.02;               // Of them for one mesh: its own numbers need some, too.

/// How much of a scene's samples a mesh gets, by its faces: many small meshes cost little more than one large one.
double share_of_samples(const Scene& scene, const Mesh& mesh) {
  std::size_t all = 0;
  for (const SceneMesh& other : scene.meshes()) all += other.mesh.face_count();
  return std::max(static_cast<double>(mesh.face_count()) / static_cast<double>(all), kLeastShare);
}

DeviationOptions level_measure(double share = 1) {
  DeviationOptions options;
  options.sample_count = static_cast<std::size_t>(share * kSceneSamples);
  options.relative_tolerance = 0.01;
  return options;
}

/// Whether the two surfaces are nowhere farther from each other than `limit`, in mesh units.
bool lies_within(const Mesh& a, const Mesh& b, double limit) {
  return measure_maximum(a, SurfaceIndex(a), b, level_measure(), limit).maximum_bound() <= limit;
}

/// One level of one mesh, in the making.
struct LevelJob {
  std::size_t mesh = 0;
  std::size_t level = 0;
  AssetLevel made;
};

/// One run of the command: its steps in order, and what they hand on to each other.
class BuildRun {
 public:
  BuildRun(const BuildCommand& options, ProgressBar& progress) : options_(options), progress_(progress) {}

  Result<Outcome> run();
  BuildReport take_report() { return std::move(report_); }

 private:
  std::size_t file_count() const { return has_file_per_level(options_) ? report_.levels.size() : 1; }
  bool wants_streams() const { return !options_.no_stream && !has_file_per_level(options_); }
  TargetScope scope() const { return options_.per_mesh ? TargetScope::Mesh : TargetScope::Scene; }

  Result<void> read();
  Result<void> simplify_meshes();
  Result<void> read_controls();
  Result<SimplifyOptions> options_for(const SceneMesh& mesh) const;
  StopCriteria stop_criteria(const SceneMesh& mesh) const;
  void report_simplified(const SceneMesh& mesh, const SimplifyResult& result);
  std::vector<double> world_charges(const SimplifyResult& result, double scale) const;
  void choose_levels();
  double world_beyond(const SceneChoice& choice) const;
  AssetOptions storage() const;
  double smallest_error() const;
  bool repeats(std::size_t mesh, std::size_t level) const;
  bool is_whole(std::size_t mesh, std::size_t level) const;
  void make_levels();
  bool fits_levels(const SceneMesh& mesh) const;
  Mesh fitted_to(std::size_t mesh, const Mesh& level) const;
  double measured_error(std::size_t mesh, Index position) const;
  void make_mesh_level(LevelJob& job) const;
  void take_mesh_level(LevelJob&& job);
  void report_level(const SceneChoice& choice);
  bool report_missed_targets() const;
  std::string missed_faces(const std::string& targets, const std::string& faces, double beyond) const;
  std::string missed_errors(const std::string& targets) const;
  void add_note(const std::string& note);
  Result<void> encode_streams();
  Result<std::vector<EncodedAsset>> encode();
  void measure_levels(std::span<std::vector<AssetLevel>> meshes, std::size_t first);
  void measure_mesh_level(std::size_t mesh, std::size_t number, const Mesh& level);
  void report_measured(std::size_t number);
  Result<void> write();
  Result<std::string> page() const;
  std::vector<ScenePart> parts() const;
  void report_layouts(std::span<const EncodedAsset> assets);

  const BuildCommand& options_;
  ProgressBar& progress_;
  Stopwatch stopwatch_;
  std::vector<LevelTarget> targets_;
  SimplifyOptions common_options_;
  BuildSettings settings_;
  std::optional<Scene> scene_;
  std::vector<SimplifyResult> simplified_;  // by mesh, as the next
  std::vector<SceneChoice> choices_;        // by level
  std::vector<LeveledMesh> levels_;
  std::vector<LeveledMesh> decoded_;  // the levels as the files have them; for the page
  BuildReport report_;
};

Result<Outcome> BuildRun::run() {
  Result<std::vector<LevelTarget>> requested = requested_levels(options_);
  if (!requested) return tl::unexpected(requested.error());
  targets_ = std::move(*requested);
  if (Result<void> paths = check_paths(options_, targets_.size() + 1); !paths) return tl::unexpected(paths.error());
  if (Result<void> done = read_controls(); !done) return tl::unexpected(done.error());
  report_.settings = settings_json(options_, common_options_.weights, targets_.size() + 1);

  if (Result<void> done = read(); !done) return tl::unexpected(done.error());
  if (Result<void> done = simplify_meshes(); !done) return tl::unexpected(done.error());
  make_levels();
  progress_.clear();
  if (report_missed_targets() && options_.strict) return Outcome::TargetNotMet;

  if (Result<void> done = write(); !done) return tl::unexpected(done.error());
  return Outcome::Done;
}

Result<void> BuildRun::read_controls() {
  Result<SimplifyOptions> common = simplify_options(options_);
  if (!common) return tl::unexpected(common.error());
  common_options_ = std::move(*common);
  if (!options_.settings) return {};
  Result<BuildSettings> settings = read_settings(*options_.settings);
  if (!settings) return tl::unexpected(settings.error());
  settings_ = std::move(*settings);
  return {};
}

Result<void> BuildRun::read() {
  progress_.start("reading", kReadingShare);
  Result<Scene> scene = read_scene(options_.input, options_.input_format);
  progress_.clear();
  if (!scene) return tl::unexpected(scene.error());
  scene_ = std::move(*scene);
  if (Result<void> fit = check_input(options_.input, *scene_); !fit) return fit;
  if (Result<void> known = check_names(settings_, *scene_); !known) return known;
  report_.input = input_report(options_.input, *scene_);
  sort_finest_first(targets_, {report_.input.face_count, scene_->box().diagonal()});
  std::vector<std::string> lines = remarks(*scene_);
  for (std::string& line : options_.targets.remarks(scene_->box().diagonal(), scene_->in_metres()))
    lines.push_back(std::move(line));
  for (const std::string& line : lines) print_warning(quoted(options_.input) + ": " + line);
  report_.timings_ms.read = stopwatch_.lap_ms();
  return {};
}

/// Where to stop: at the base mesh for the stream's sake; without a stream once the coarsest level is surely reached.
/// Only face counts of the mesh itself can tell early: what errors are, and what is left for a mesh of what a scene may
/// have, is settled when the whole run is known.
StopCriteria BuildRun::stop_criteria(const SceneMesh& mesh) const {
  StopCriteria stop;
  const bool alone = options_.per_mesh || (scene_->meshes().size() == 1 && mesh.instance_count == 1);
  if (wants_streams() || !alone || targets_.empty() || targets_.back().kind != TargetKind::Faces) return stop;
  const LevelTarget coarsest = resolve(targets_.back(), {mesh.mesh.face_count(), 0});
  stop.min_faces = static_cast<std::size_t>(std::max(0.0, coarsest.value - kMostFacesOfOneRemoval));
  return stop;
}

Result<SimplifyOptions> BuildRun::options_for(const SceneMesh& mesh) const {
  SimplifyOptions options = common_options_;
  options.stop = stop_criteria(mesh);
  options.weights.target_reach = mesh.target_reach;
  Result<std::vector<float>> importance = vertex_importance(mesh, settings_, options_.importance);
  if (!importance) return tl::unexpected(importance.error());
  options.importance = std::move(*importance);
  // Bounds of every record are for the stream, for levels by error, and for sharing faces among meshes.
  const bool by_error = !targets_.empty() && targets_.back().kind == TargetKind::Error;
  const bool shared = scene_->meshes().size() > 1 && !options_.per_mesh;
  if (!wants_streams() && !by_error && !shared) options.measure_step = 0;
  return options;
}

Result<void> BuildRun::simplify_meshes() {
  progress_.start("simplifying", kSimplifyingShare);
  const std::vector<SceneMesh>& meshes = scene_->meshes();
  std::vector<Result<SimplifyResult>> results(meshes.size());
  SharedProgress shared(progress_);
  for (const SceneMesh& mesh : meshes) shared.add_part(static_cast<double>(mesh.mesh.face_count()));
  for_each_in_parallel(meshes.size(), [&](std::size_t i) {
    Result<SimplifyOptions> options = options_for(meshes[i]);
    if (!options) {
      results[i] = tl::unexpected(options.error());
      return;
    }
    options->progress = [&, i](double share) {
      shared.update(i, share);
      return true;
    };
    results[i] = simplify(meshes[i].mesh, *options);
  });
  progress_.clear();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    Result<SimplifyResult>& result = results[i];
    if (!result)
      return fail(result.error().code,
                  "mesh " + tool::quoted(std::string_view(meshes[i].name)) + ": " + result.error().message);
    report_simplified(meshes[i], *result);
    simplified_.push_back(std::move(*result));
  }
  report_.timings_ms.simplify = stopwatch_.lap_ms();
  return {};
}

void BuildRun::report_simplified(const SceneMesh& mesh, const SimplifyResult& result) {
  const ProgressiveMesh& progressive = result.mesh;
  const std::size_t round_count = progressive.round_begin.empty() ? 0 : progressive.round_begin.size() - 1;
  const BuildReport::Stream stream{
      0, progressive.record_count(), round_count, face_counts(progressive).front(), result.stop_reason, result.blocked};
  report_.meshes.push_back({mesh.name, mesh.instance_count, mesh.scale, mesh.assembly, stream, {}});
  BuildReport::Stream& total = report_.stream;
  if (report_.meshes.size() == 1) total.stop_reason = stream.stop_reason;
  if (total.stop_reason != stream.stop_reason) total.stop_reason = StopReason::Stuck;
  total.record_count += stream.record_count;
  total.round_count += stream.round_count;
  total.base_face_count += stream.base_face_count * mesh.instance_count;
  total.blocked = total.blocked + stream.blocked;
}

/// What was charged for each position, in world units; angles know no units.
std::vector<double> BuildRun::world_charges(const SimplifyResult& result, double scale) const {
  std::vector<double> charges(result.charge.begin(), result.charge.end());
  if (common_options_.metric != Metric::Gaussian)
    for (double& charge : charges) charge *= scale;
  return charges;
}

void BuildRun::make_levels() {
  progress_.start("making levels", kMakingShare);
  choose_levels();
  levels_.resize(simplified_.size());
  std::vector<LevelJob> jobs;
  for (std::size_t mesh = 0; mesh < simplified_.size(); ++mesh)
    for (std::size_t level = 0; level < choices_.size(); ++level) jobs.push_back({mesh, level, {}});
  SharedProgress shared(progress_);
  for (std::size_t i = 0; i < jobs.size(); ++i) shared.add_part(1);
  for_each_in_parallel(jobs.size(), [&](std::size_t i) {
    if (!repeats(jobs[i].mesh, jobs[i].level)) make_mesh_level(jobs[i]);
    shared.update(i, 1);
  });
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (repeats(jobs[i].mesh, jobs[i].level)) jobs[i].made = jobs[i - 1].made;
  for (LevelJob& job : jobs) take_mesh_level(std::move(job));
  for (const SceneChoice& choice : choices_) report_level(choice);
  report_.timings_ms.levels = stopwatch_.lap_ms();
}

/// The smallest error that a level may have, world units; infinite where levels are not by error.
double BuildRun::smallest_error() const {
  double smallest = std::numeric_limits<double>::infinity();
  for (const LevelTarget& target : targets_) {
    if (target.kind != TargetKind::Error) continue;
    if (!target.relative || scope() == TargetScope::Scene)
      smallest = std::min(smallest, resolve(target, {0, scene_->box().diagonal()}).value);
    else
      for (const SceneMesh& mesh : scene_->meshes())
        smallest = std::min(smallest, target.value * bounding_box(mesh.mesh).diagonal() * mesh.scale);
  }
  return smallest;
}

/// How the levels are stored: of an error that is asked for, quantisation may take its share.
AssetOptions BuildRun::storage() const {
  AssetOptions options = asset_options(options_);
  options.draco_position_error = kQuantisationShare * smallest_error();
  return options;
}

std::vector<ScenePart> BuildRun::parts() const {
  const std::vector<double> displacements = quantisation_errors(*scene_, storage());
  std::vector<ScenePart> parts;
  for (std::size_t i = 0; i < simplified_.size(); ++i) {
    const SceneMesh& mesh = scene_->meshes()[i];
    parts.push_back({&simplified_[i].mesh, mesh.scale, mesh.instance_count, simplified_[i].stop_reason,
                     settings_.importance_of(mesh), world_charges(simplified_[i], mesh.scale),
                     [this, i](Index position) { return measured_error(i, position); }, kBoxGrowth * displacements[i]});
  }
  return parts;
}

/// Finds each mesh's positions: the whole scene, then what answers the targets. What would repeat the level before is
/// left out.
void BuildRun::choose_levels() {
  const std::vector<ScenePart> parts = this->parts();
  choices_ = {{{}, {}, true, "whole", {}}};
  for (const SimplifyResult& result : simplified_)
    choices_[0].positions.push_back(static_cast<Index>(result.mesh.record_count()));
  for (const LevelTarget& target : targets_) {
    SceneChoice choice = choose_positions(parts, target, scope(), scene_->box().diagonal());
    const std::vector<Index>& before = choices_.back().positions;
    for (std::size_t i = 0; i < before.size() && !choice.met; ++i)
      choice.positions[i] = std::min(choice.positions[i], before[i]);
    if (choice.positions == before)
      report_.left_out.push_back(
          {choice.target, choice.met, choice.stopped_by, world_beyond(choice), choices_.size() - 1});
    else
      choices_.push_back(std::move(choice));
  }
}

/// What faces asked for would have cost, in world units; 0 where no error stopped the level before them.
double BuildRun::world_beyond(const SceneChoice& choice) const {
  double largest = 0;
  for (std::size_t i = 0; i < choice.beyond.size(); ++i)
    largest = std::max(largest, choice.beyond[i] * scene_->meshes()[i].scale);
  return largest;
}

/// Whether a mesh's level is the one before.
bool BuildRun::repeats(std::size_t mesh, std::size_t level) const {
  return level > 0 && choices_[level].positions[mesh] == choices_[level - 1].positions[mesh];
}

bool BuildRun::is_whole(std::size_t mesh, std::size_t level) const {
  return choices_[level].positions[mesh] == simplified_[mesh].mesh.record_count();
}

void BuildRun::report_level(const SceneChoice& choice) {
  BuildReport::Level entry;
  const std::size_t number = report_.levels.size();
  for (std::size_t i = 0; i < simplified_.size(); ++i) {
    const SceneMesh& mesh = scene_->meshes()[i];
    const BuildReport::MeshPart::Level& part = report_.meshes[i].levels[number];
    entry.face_count += part.face_count * mesh.instance_count;
    entry.vertex_count += part.vertex_count * mesh.instance_count;
    entry.deviation_bound = std::max(entry.deviation_bound, part.deviation_bound * mesh.scale);
    entry.curvature_error = std::max(entry.curvature_error, levels_[i].levels[number].curvature_error);
  }
  if (number > 0) entry.target = choice.target;
  entry.met = choice.met;
  entry.stopped_by = choice.stopped_by;
  entry.deviation_beyond = world_beyond(choice);
  report_.levels.push_back(std::move(entry));
}

void BuildRun::take_mesh_level(LevelJob&& job) {
  const SceneChoice& choice = choices_[job.level];
  job.made.stop_reason = choice.stopped_by;
  if (!choice.beyond.empty()) job.made.deviation_beyond = choice.beyond[job.mesh];
  const float bound = simplified_[job.mesh].mesh.deviation[choice.positions[job.mesh]];
  report_.meshes[job.mesh].levels.push_back({job.made.mesh.face_count(), job.made.mesh.vertex_count(), {}, bound, {}});
  levels_[job.mesh].levels.push_back(std::move(job.made));
}

/// Vertices of skinned and morphed meshes take their weights and targets with them, so those stay where they are.
bool BuildRun::fits_levels(const SceneMesh& mesh) const {
  return options_.placement == "optimised" && !mesh.skinned && !mesh.has_targets;
}

Mesh BuildRun::fitted_to(std::size_t mesh, const Mesh& level) const {
  PlacementOptions placement;
  placement.fixed = simplified_[mesh].locked;
  return optimise_placement(scene_->meshes()[mesh].mesh, level, placement);
}

/// What a level for a number of faces really deviates by, in mesh units, but for quantisation.
double BuildRun::measured_error(std::size_t mesh, Index position) const {
  const ProgressiveMesh& progressive = simplified_[mesh].mesh;
  Cursor cursor(progressive);
  cursor.seek(position);
  Mesh level = extract_level(progressive, cursor);
  const SceneMesh& source = scene_->meshes()[mesh];
  if (fits_levels(source)) level = fitted_to(mesh, level);
  return measure_maximum(source.mesh, SurfaceIndex(source.mesh), level, level_measure()).maximum_bound();
}

/// Extracts a level and fits it to the original, unless an error was asked for that only the stream's level keeps to.
void BuildRun::make_mesh_level(LevelJob& job) const {
  const Index position = choices_[job.level].positions[job.mesh];
  const SceneMesh& source = scene_->meshes()[job.mesh];
  const ProgressiveMesh& progressive = simplified_[job.mesh].mesh;
  AssetLevel& level = job.made;
  level.curvature_error = progressive.curvature_error[position];
  Cursor cursor(progressive);
  cursor.seek(position);
  level.mesh = extract_level(progressive, cursor);
  if (!fits_levels(source) || is_whole(job.mesh, job.level)) return;
  Mesh fitted = fitted_to(job.mesh, level.mesh);
  const double bound = static_cast<double>(progressive.deviation[position]);
  const bool is_limited = choices_[job.level].target.kind == TargetKind::Error;
  if (!is_limited || lies_within(source.mesh, fitted, bound)) level.mesh = std::move(fitted);
}

/// Measures levels as a file has them; the first of each mesh is number `first`.
void BuildRun::measure_levels(std::span<std::vector<AssetLevel>> meshes, std::size_t first) {
  report_.timings_ms.write += stopwatch_.lap_ms();
  const double share_of_files = 1.0 / static_cast<double>(file_count());
  progress_.start("measuring levels", kMeasuringShare * share_of_files);
  SharedProgress shared(progress_);
  const std::size_t count = meshes.front().size();
  for (std::size_t i = 0; i < meshes.size() * count; ++i) shared.add_part(1);
  for_each_in_parallel(meshes.size() * count, [&](std::size_t i) {
    const std::size_t mesh = i / count, level = i % count;
    if (level == 0 || !repeats(mesh, first + level)) measure_mesh_level(mesh, first + level, meshes[mesh][level].mesh);
    shared.update(i, 1);
  });
  decoded_.resize(meshes.size());
  for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh) {
    std::vector<BuildReport::MeshPart::Level>& reported = report_.meshes[mesh].levels;
    for (std::size_t level = 0; level < count; ++level) {
      const std::size_t number = first + level;
      if (level > 0 && repeats(mesh, number)) reported[number] = reported[number - 1];
      meshes[mesh][level].deviation = reported[number].deviation;
      if (options_.html) decoded_[mesh].levels.push_back(meshes[mesh][level]);
    }
  }
  for (std::size_t level = 0; level < count; ++level) report_measured(first + level);
  report_.timings_ms.levels += stopwatch_.lap_ms();
  progress_.start("writing", kWritingShare * share_of_files);
}

/// Measures one level of one mesh, unless the file has the whole mesh as it was.
void BuildRun::measure_mesh_level(std::size_t mesh, std::size_t number, const Mesh& level) {
  if (options_.no_draco && is_whole(mesh, number)) return;
  const Mesh& whole = scene_->meshes()[mesh].mesh;
  BuildReport::MeshPart::Level& reported = report_.meshes[mesh].levels[number];
  reported.vertex_count = level.vertex_count();
  const double share = share_of_samples(*scene_, whole);
  reported.deviation = measure_deviation(whole, level, level_measure(share));
  reported.attributes = measure_attributes(whole, level, static_cast<std::size_t>(share * kSceneAttributeSamples));
}

void BuildRun::report_measured(std::size_t number) {
  DeviationTotal total;
  std::size_t vertex_count = 0;
  for (std::size_t i = 0; i < report_.meshes.size(); ++i) {
    const SceneMesh& mesh = scene_->meshes()[i];
    total.add(report_.meshes[i].levels[number].deviation, mesh.scale, mesh.area);
    vertex_count += report_.meshes[i].levels[number].vertex_count * mesh.instance_count;
  }
  report_.levels[number].vertex_count = vertex_count;
  report_.levels[number].deviation = total.result();
}

/// `faces` are left, where fewer would have been off by up to `beyond`, or there are none.
std::string BuildRun::missed_faces(const std::string& targets, const std::string& faces, double beyond) const {
  const std::string why = beyond > 0 ? "fewer would be up to " + percent_text(beyond, scene_->box().diagonal()) + " off"
                                     : "there are no fewer; " + blocked_text(report_.stream.blocked);
  return targets + " faces were asked for" + (options_.per_mesh ? " of each mesh, " : ", ") + faces +
         " are left: " + why;
}

/// Only quantisation is in the way of an error: the whole mesh has none.
std::string BuildRun::missed_errors(const std::string& targets) const {
  double farthest = 0;
  for (const ScenePart& part : parts()) farthest = std::max(farthest, part.displacement * part.scale);
  return "errors of " + targets + " were asked for, Draco's grid alone moves vertices by " + number_text(farthest);
}

/// Says which levels have more faces or larger errors than asked for, and why; returns whether there are any.
bool BuildRun::report_missed_targets() const {
  std::string levels, targets, faces;
  double beyond = 0;
  for (std::size_t i = 0; i < report_.levels.size(); ++i) {
    std::string missed, last;
    const auto miss = [&](const LevelTarget& target, double deviation_beyond) {
      if (const std::string text = target_text(target); text != last) append_item(missed, last = text);
      beyond = std::max(beyond, deviation_beyond);
    };
    const BuildReport::Level& level = report_.levels[i];
    if (!level.met) miss(*level.target, level.deviation_beyond);
    for (const BuildReport::LeftOut& left_out : report_.left_out)
      if (!left_out.met && left_out.level == i) miss(left_out.target, left_out.deviation_beyond);
    if (missed.empty()) continue;
    append_item(levels, std::to_string(i));
    append_item(targets, missed);
    append_item(faces, std::to_string(level.face_count));
  }
  if (targets.empty()) return false;
  const bool by_error = targets_.front().kind == TargetKind::Error;
  const std::string message = "target not met by level " + levels + ": " +
                              (by_error ? missed_errors(targets) : missed_faces(targets, faces, beyond));
  options_.strict ? print_error(message) : print_warning(message);
  return true;
}

/// Says what the file has otherwise than one would think; once, where several files have it.
void BuildRun::add_note(const std::string& note) {
  std::vector<std::string>& notes = report_.input.notes;
  if (std::find(notes.begin(), notes.end(), note) != notes.end()) return;
  notes.push_back(note);
  print_warning(note);
}

/// A mesh that is beyond the stream's limits goes without one; its levels do not need it.
Result<void> BuildRun::encode_streams() {
  if (!wants_streams()) return {};
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    Result<std::vector<std::byte>> stream = encode_stream(simplified_[i].mesh);
    if (!stream && stream.error().code != ErrorCode::LimitExceeded) return tl::unexpected(stream.error());
    if (!stream) {
      add_note("mesh " + tool::quoted(std::string_view(scene_->meshes()[i].name)) +
               " has no removal stream: " + stream.error().message);
      continue;
    }
    report_.meshes[i].stream.bytes = stream->size();
    levels_[i].stream = std::move(*stream);
  }
  return {};
}

Result<std::vector<EncodedAsset>> BuildRun::encode() {
  AssetOptions options = storage();
  std::vector<EncodedAsset> assets;
  const std::vector<std::filesystem::path> paths = output_paths(options_, file_count());
  for (std::size_t i = 0; i < file_count(); ++i) {
    if (lower_extension(paths[i]) == ".gltf") options.gltf_name = paths[i].stem().string();
    options.measure = [&](std::span<std::vector<AssetLevel>> meshes) { measure_levels(meshes, i); };
    Result<EncodedAsset> asset = has_file_per_level(options_) ? encode_scene_level(*scene_, levels_, i, options)
                                                              : encode_scene(*scene_, levels_, options);
    if (!asset) return tl::unexpected(asset.error());
    for (const std::string& note : asset->layout.notes) add_note(note);
    assets.push_back(std::move(*asset));
  }
  return assets;
}

Result<void> BuildRun::write() {
  progress_.start("writing", 0);  // the levels are encoded first, and measured
  if (Result<void> done = encode_streams(); !done) return done;
  const Result<std::vector<EncodedAsset>> assets = encode();
  if (!assets) return tl::unexpected(assets.error());
  report_layouts(*assets);
  list_files(options_, *assets, report_);
  report_.timings_ms.write += stopwatch_.lap_ms();
  const Result<std::string> html = page();
  if (!html) return tl::unexpected(html.error());
  const Result<void> done = write_outputs(options_, *assets, report_, *html);
  progress_.clear();
  return done;
}

/// Returns the page of --html; nothing without it.
Result<std::string> BuildRun::page() const {
  if (!options_.html) return std::string();
  return build_page(report_, *scene_, decoded_, wants_streams() ? parts() : std::vector<ScenePart>());
}

void BuildRun::report_layouts(std::span<const EncodedAsset> assets) {
  const bool one_file = assets.size() == 1;
  for (std::size_t i = 0; i < report_.levels.size(); ++i) {
    const AssetLayout& layout = one_file ? assets[0].layout : assets[i].layout;
    report_.levels[i].bytes = layout.levels[one_file ? i : 0].geometry_bytes;
  }
  report_.stream.bytes = assets[0].layout.stream_bytes;
  report_.output_path = options_.output.string();
  for (const EncodedAsset& asset : assets) {
    report_.quantisation_error = std::max(report_.quantisation_error, asset.layout.quantisation_error);
    report_.position_bits = std::max(report_.position_bits, asset.layout.position_bits);
  }
}

}  // namespace

Result<BuildResult> run_build(const BuildCommand& options, ProgressBar& progress) {
  BuildRun run(options, progress);
  const Result<Outcome> outcome = run.run();
  if (!outcome) return tl::unexpected(outcome.error());
  return BuildResult{*outcome, run.take_report()};
}

}  // namespace lodestone::tool

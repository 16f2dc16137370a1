#include "build_run.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>

#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "build_report.h"
#include "messages.h"
#include "progress_bar.h"
#include "staged_file.h"
#include "stopwatch.h"
#include "text_table.h"
#include "unsupported_content.h"

namespace lodestone::tool {
namespace {

constexpr int kDefaultLevelCount = 5;
constexpr double kDefaultRatio = 0.5;
constexpr double kMostFacesOfOneRemoval = 2;

Metric metric_of(const std::string& name) {
  if (name == "gaussian") return Metric::Gaussian;
  if (name == "mean") return Metric::Mean;
  if (name == "principal") return Metric::Principal;
  return Metric::Hybrid;
}

Normalisation normalisation_of(const std::string& name) {
  return name == "density" ? Normalisation::Density : Normalisation::Integral;
}

Reference reference_of(const std::string& name) { return name == "current" ? Reference::Current : Reference::Original; }

Result<void> check_paths(const BuildCommand& options) {
  std::error_code ignored;
  if (options.output.extension() != ".glb") {
    return fail(ErrorCode::InvalidArgument, "-o: " + quoted(options.output) + " does not end in .glb");
  }
  if (std::filesystem::equivalent(options.input, options.output, ignored)) {
    return fail(ErrorCode::InvalidArgument, "-o: " + quoted(options.output) + " is the input");
  }
  if (options.report && options.report->lexically_normal() == options.output.lexically_normal()) {
    return fail(ErrorCode::InvalidArgument, "--report: " + quoted(*options.report) + " is the output");
  }
  Result<void> place = check_destination(options.output);
  if (place && options.report) place = check_destination(*options.report);
  return place;
}

std::vector<std::string> remarks(const MeshFile& file) {
  std::vector<std::string> lines = file.notes;
  for (std::string& line : sentences(file.assembly)) lines.push_back(std::move(line));
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "; ") + line;
  return text;
}

/// Refuses what would not come out as the asset that went in.
Result<void> check_input(const std::filesystem::path& path, const MeshFile& file) {
  const std::string lost = joined(unsupported_content(file.notes));
  if (!lost.empty()) return fail(ErrorCode::Unsupported, quoted(path) + ": not supported yet: " + lost);
  if (file.mesh.face_count() > 0) return {};
  const std::string why = joined(remarks(file));
  return fail(ErrorCode::Malformed, quoted(path) + ": no triangles to simplify" + (why.empty() ? "" : ": " + why));
}

/// The targets of the levels after the whole mesh, as the options ask for them.
Result<std::vector<LevelTarget>> requested_levels(const BuildCommand& options) {
  Result<std::vector<LevelTarget>> given = options.targets.parse();
  if (!given) return given;
  const bool by_ratio = given->empty() || options.targets.ratio;
  if (!by_ratio && options.level_count) {
    return fail(ErrorCode::InvalidArgument, "--levels goes with --ratio; a list has one level for each entry");
  }
  if (!by_ratio) return given;
  const double ratio = given->empty() ? kDefaultRatio : given->front().value;
  std::vector<LevelTarget> levels;
  for (int i = 1; i < options.level_count.value_or(kDefaultLevelCount); ++i) {
    levels.push_back({TargetKind::Faces, std::pow(ratio, i), true});
  }
  return levels;
}

/// Absolute targets, finest first.
std::vector<LevelTarget> resolve_all(std::vector<LevelTarget> targets, const FullSize& full) {
  for (LevelTarget& target : targets) target = resolve(target, full);
  std::stable_sort(targets.begin(), targets.end(), [](const LevelTarget& a, const LevelTarget& b) {
    return a.kind == TargetKind::Faces ? a.value > b.value : a.value < b.value;
  });
  return targets;
}

/// Where to stop: at the base mesh for the stream's sake; without a stream once the coarsest level is surely reached.
/// Only face counts can tell early: what a level's errors are is settled when the whole run is known.
StopCriteria stop_criteria(const BuildCommand& options, std::span<const LevelTarget> targets) {
  StopCriteria stop;
  if (!options.no_stream || targets.empty() || targets.back().kind != TargetKind::Faces) return stop;
  stop.min_faces = static_cast<std::size_t>(std::max(0.0, targets.back().value - kMostFacesOfOneRemoval));
  return stop;
}

Json settings_json(const BuildCommand& options, std::span<const LevelTarget> targets) {
  Json json = {{"metric", options.metric},     {"normalise", options.normalisation}, {"reference", options.reference},
               {"levels", targets.size() + 1}, {"stream", !options.no_stream},       {"draco", !options.no_draco}};
  json["position_bits"] = options.no_draco ? Json(nullptr) : Json(options.position_bits);
  return json;
}

/// The farthest a vertex moves when each coordinate goes to the nearest of 2^bits steps over the box's longest side.
double quantisation_error(const Box& box, int bits) {
  const Vec3 size = box.high - box.low;
  const double step = std::max({size.x, size.y, size.z}) / (std::exp2(bits) - 1);
  return std::sqrt(3.0) / 2 * step;
}

void append_item(std::string& list, const std::string& item) { list += (list.empty() ? "" : ", ") + item; }

/// Why the base mesh's vertices stay.
std::string blocked_text(const BlockedCounts& blocked) {
  std::string text;
  if (blocked.locked > 0) append_item(text, std::to_string(blocked.locked) + " on features this version keeps");
  if (blocked.flip > 0) append_item(text, std::to_string(blocked.flip) + " would turn a face over");
  if (blocked.link > 0) append_item(text, std::to_string(blocked.link) + " would double an edge");
  if (blocked.ring > 0) append_item(text, std::to_string(blocked.ring) + " have too many neighbours");
  return "vertices left: " + (text.empty() ? "none" : text);
}

/// Two digits for a table and a report, in a fraction of the time that `compare` takes for its four.
DeviationOptions level_measure() {
  DeviationOptions options;
  options.sample_count = 50'000;
  options.relative_tolerance = 0.01;
  return options;
}

/// One run of the command: its steps in order, and what they hand on to each other.
class BuildRun {
 public:
  explicit BuildRun(const BuildCommand& options) : options_(options), progress_(!options.quiet) {}

  Result<Outcome> run();

 private:
  Result<void> read();
  Result<void> simplify_input(std::span<const LevelTarget> targets);
  void make_levels(std::span<const LevelTarget> targets);
  void add_level(Cursor& cursor, const LevelChoice& choice, bool whole);
  bool report_missed_targets() const;
  Result<void> write();
  Result<std::vector<std::byte>> encode_stream_if_wanted() const;
  void report_layout(const EncodedAsset& asset);

  const BuildCommand& options_;
  ProgressBar progress_;
  Stopwatch stopwatch_;
  MeshFile file_;
  SimplifyResult simplified_;
  std::vector<AssetLevel> levels_;
  BuildReport report_;
};

Result<Outcome> BuildRun::run() {
  if (Result<void> paths = check_paths(options_); !paths) return tl::unexpected(paths.error());
  Result<std::vector<LevelTarget>> requested = requested_levels(options_);
  if (!requested) return tl::unexpected(requested.error());

  if (Result<void> done = read(); !done) return tl::unexpected(done.error());
  const FullSize full{file_.mesh.face_count(), report_.input.box.diagonal()};
  const std::vector<LevelTarget> targets = resolve_all(std::move(*requested), full);
  report_.settings = settings_json(options_, targets);

  if (Result<void> done = simplify_input(targets); !done) return tl::unexpected(done.error());
  make_levels(targets);
  progress_.clear();
  if (report_missed_targets() && options_.strict) return Outcome::TargetNotMet;

  if (Result<void> done = write(); !done) return tl::unexpected(done.error());
  if (!options_.quiet) print_table(report_);
  return Outcome::Done;
}

Result<void> BuildRun::read() {
  progress_.start("reading");
  Result<MeshFile> file = read_mesh(options_.input);
  progress_.clear();
  if (!file) return tl::unexpected(file.error());
  file_ = std::move(*file);
  if (Result<void> fit = check_input(options_.input, file_); !fit) return fit;
  report_.input = {options_.input.string(),  file_.mesh.face_count(), file_.mesh.vertex_count(),
                   bounding_box(file_.mesh), file_.assembly,          file_.notes};
  for (const std::string& line : remarks(file_)) print_warning(quoted(options_.input) + ": " + line);
  report_.timings_ms.read = stopwatch_.lap_ms();
  return {};
}

Result<void> BuildRun::simplify_input(std::span<const LevelTarget> targets) {
  progress_.start("simplifying");
  SimplifyOptions options;
  options.metric = metric_of(options_.metric);
  options.normalisation = normalisation_of(options_.normalisation);
  options.reference = reference_of(options_.reference);
  options.stop = stop_criteria(options_, targets);
  // Bounds of every record are for the stream, and for finding levels by error.
  const bool by_error = !targets.empty() && targets.back().kind == TargetKind::Error;
  if (options_.no_stream && !by_error) options.measure_step = 0;
  options.progress = [this](double share) {
    progress_.update(share);
    return true;
  };
  Result<SimplifyResult> result = simplify(file_.mesh, options);
  progress_.clear();
  if (!result) return tl::unexpected(result.error());
  simplified_ = std::move(*result);
  const ProgressiveMesh& mesh = simplified_.mesh;
  const std::size_t round_count = mesh.round_begin.empty() ? 0 : mesh.round_begin.size() - 1;
  report_.stream = {
      0, mesh.record_count(), round_count, face_counts(mesh).front(), simplified_.stop_reason, simplified_.blocked};
  report_.timings_ms.simplify = stopwatch_.lap_ms();
  return {};
}

void BuildRun::make_levels(std::span<const LevelTarget> targets) {
  progress_.start("measuring levels");
  Cursor cursor(simplified_.mesh);
  const LevelChoice whole{{}, static_cast<Index>(simplified_.mesh.record_count()), true, "whole"};
  add_level(cursor, whole, true);
  for (const LevelTarget& target : targets) {
    progress_.update(static_cast<double>(levels_.size() - 1) / static_cast<double>(targets.size()));
    add_level(cursor, choose_level(simplified_.mesh, target, simplified_.stop_reason), false);
  }
  report_.timings_ms.levels = stopwatch_.lap_ms();
}

void BuildRun::add_level(Cursor& cursor, const LevelChoice& choice, bool whole) {
  cursor.seek(choice.position);
  AssetLevel level;
  level.mesh = extract_level(simplified_.mesh, cursor);
  if (choice.position < simplified_.mesh.record_count())
    level.deviation = measure_deviation(file_.mesh, level.mesh, level_measure());
  level.curvature_error = simplified_.mesh.curvature_error[choice.position];
  level.stop_reason = choice.stopped_by;

  BuildReport::Level entry;
  entry.face_count = level.mesh.face_count();
  entry.vertex_count = level.mesh.vertex_count();
  entry.deviation = level.deviation;
  entry.deviation_bound = simplified_.mesh.deviation[choice.position];
  entry.curvature_error = level.curvature_error;
  if (!whole) entry.target = choice.target;
  entry.met = choice.met;
  entry.stopped_by = choice.stopped_by;
  report_.levels.push_back(std::move(entry));
  levels_.push_back(std::move(level));
}

/// Says which levels have more faces than asked for, and why; returns whether there are any.
bool BuildRun::report_missed_targets() const {
  std::string levels;
  std::string targets;
  for (std::size_t i = 0; i < report_.levels.size(); ++i) {
    if (report_.levels[i].met) continue;
    append_item(levels, std::to_string(i));
    append_item(targets, number_text(report_.levels[i].target->value, 15));
  }
  if (levels.empty()) return false;
  const std::string message = "target not met by level " + levels + ": " + targets + " faces were asked for, " +
                              std::to_string(report_.levels.back().face_count) + " are the fewest there are; " +
                              blocked_text(simplified_.blocked);
  options_.strict ? print_error(message) : print_warning(message);
  return true;
}

Result<std::vector<std::byte>> BuildRun::encode_stream_if_wanted() const {
  if (options_.no_stream) return std::vector<std::byte>{};
  return encode_stream(simplified_.mesh);
}

Result<void> BuildRun::write() {
  progress_.start("writing");
  const Result<std::vector<std::byte>> stream = encode_stream_if_wanted();
  if (!stream) return tl::unexpected(stream.error());
  AssetOptions asset_options;
  asset_options.draco = !options_.no_draco;
  asset_options.draco_position_bits = options_.position_bits;
  asset_options.name = options_.input.stem().string();
  const Result<EncodedAsset> asset = encode_asset(levels_, *stream, asset_options);
  if (!asset) return tl::unexpected(asset.error());

  StagedFile output(options_.output);
  if (Result<void> done = output.write(asset->glb); !done) return done;
  report_layout(*asset);
  report_.timings_ms.write = stopwatch_.lap_ms();
  progress_.clear();
  if (!options_.report) return output.commit();

  StagedFile report(*options_.report);
  const std::string text = json_text(report_json(report_));
  if (Result<void> done = report.write(std::as_bytes(std::span(text))); !done) return done;
  if (Result<void> done = output.commit(); !done) return done;
  return report.commit();
}

void BuildRun::report_layout(const EncodedAsset& asset) {
  for (std::size_t i = 0; i < report_.levels.size(); ++i) report_.levels[i].bytes = asset.layout.levels[i].byte_length;
  report_.stream.bytes = asset.layout.stream_bytes;
  report_.output_path = options_.output.string();
  report_.output_bytes = asset.layout.total_bytes;
  if (!options_.no_draco) {
    report_.quantisation_error = quantisation_error(report_.input.box, options_.position_bits);
  }
}

}  // namespace

Result<Outcome> run_build(const BuildCommand& options) { return BuildRun(options).run(); }

}  // namespace lodestone::tool

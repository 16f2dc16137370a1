// The build, stage by stage: each mesh is simplified to a stream, the levels of all are chosen together by what their
// streams promise, extracted, fitted to the original, encoded, measured as they come out of the file, and written.

#include <lodestone/pipeline/build_asset.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/cursor.h>

#include "pipeline/build_progress.h"
#include "pipeline/encode_streams.h"
#include "pipeline/first_picture.h"
#include "pipeline/level_measure.h"
#include "pipeline/level_plan.h"
#include "pipeline/make_levels.h"
#include "pipeline/shown_level.h"
#include "pipeline/simplify_scene.h"
#include "pipeline/stopwatch.h"

namespace lodestone {
namespace {

using detail::text;

using namespace detail;

/// Notes, each once, though several files may have it.
class Notes {
 public:
  Notes(BuildResult& result, BuildObserver& observer) : notes_(result.notes), observer_(observer) {}

  void add(const std::string& note) {
    if (std::find(notes_.begin(), notes_.end(), note) != notes_.end()) return;
    notes_.push_back(note);
    observer_.note(note);
  }

 private:
  std::vector<std::string>& notes_;
  BuildObserver& observer_;
};

BuildResult::Stream stream_report(const SimplifyResult& simplified) {
  const ProgressiveMesh& mesh = simplified.mesh;
  const std::size_t round_count = mesh.round_begin.empty() ? 0 : mesh.round_begin.size() - 1;
  return {0, mesh.record_count(), round_count, face_counts(mesh).front(), simplified.stop_reason, simplified.blocked};
}

void report_streams(const Scene& scene, BuildResult& result) {
  BuildResult::Stream& total = result.stream;
  for (std::size_t i = 0; i < result.simplified.size(); ++i) {
    const SceneMesh& mesh = scene.meshes()[i];
    const BuildResult::Stream stream = stream_report(result.simplified[i]);
    result.meshes.push_back({mesh.name, mesh.instance_count, mesh.scale, mesh.assembly, stream, {}});
    if (i == 0) total.stop_reason = stream.stop_reason;
    if (total.stop_reason != stream.stop_reason) total.stop_reason = StopReason::Stuck;
    total.record_count += stream.record_count;
    total.round_count += stream.round_count;
    total.base_face_count += stream.base_face_count * mesh.instance_count;
    total.blocked = total.blocked + stream.blocked;
  }
}

/// What is known of a level before it is measured.
void report_level(const Scene& scene, const LevelPlan& plan, std::size_t number, const std::vector<LeveledMesh>& levels,
                  BuildResult& result) {
  const SceneChoice& choice = plan.choices[number];
  BuildResult::Level entry;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const SceneMesh& mesh = scene.meshes()[i];
    const AssetLevel& level = levels[i].levels[number];
    const float bound = result.simplified[i].mesh.deviation[choice.positions[i]];
    result.meshes[i].levels.push_back({level.mesh.face_count(), level.mesh.vertex_count(), {}, bound, {}});
    entry.face_count += level.mesh.face_count() * mesh.instance_count;
    entry.vertex_count += level.mesh.vertex_count() * mesh.instance_count;
    entry.deviation_bound = std::max(entry.deviation_bound, bound * mesh.scale);
    entry.curvature_error = std::max(entry.curvature_error, level.curvature_error);
  }
  if (number > 0) entry.target = choice.target;
  entry.met = choice.met;
  entry.stopped_by = choice.stopped_by;
  entry.deviation_beyond = world_beyond(scene, choice);
  result.levels.push_back(std::move(entry));
}

void report_plan(const Scene& scene, const LevelPlan& plan, const std::vector<LeveledMesh>& levels,
                 BuildResult& result) {
  for (std::size_t i = 0; i < plan.level_count(); ++i) report_level(scene, plan, i, levels, result);
  result.met = is_met(plan);
  result.left_out = plan.left_out;
  result.grid_error = plan.grid_error;
}

/// Says of a plan's last level what it is now.
void report_last_level_again(const Scene& scene, const LevelPlan& plan, const std::vector<LeveledMesh>& levels,
                             BuildResult& result) {
  result.levels.pop_back();
  for (BuildResult::MeshPart& mesh : result.meshes) mesh.levels.pop_back();
  report_level(scene, plan, plan.level_count() - 1, levels, result);
}

// Of the work of making levels, the streams beside them; of that of writing, the streams that are drawn from; of what
// is left, the encoding of levels.
constexpr double kStreamsBesideShare = 0.25;
constexpr double kStreamsShare = 0.3;
constexpr double kEncodingShare = 0.9;

/// Makes the levels, and beside them the streams of a file that has all levels, too: they need none of these.
Result<std::vector<LeveledMesh>> make_levels_and_streams(MeasuredScene& measured, const BuildResult& result,
                                                         const LevelPlan& plan, const BuildOptions& options,
                                                         SceneFitter& fitter, Result<MeshStreams>& streams,
                                                         const Progress& progress) {
  const bool in_vain = options.strict && !is_met(plan);
  if (!writes_streams(options) || is_by_compact_streams(options.layout) || in_vain)
    return make_levels(measured, result.simplified, plan, fitter, progress);
  SideJobs beside;
  beside.add([&] {
    streams = encode_streams(measured.scene(), result.simplified, options, nullptr, progress.part(kStreamsBesideShare));
  });
  auto levels = make_levels(measured, result.simplified, plan, fitter, progress.part(1 - kStreamsBesideShare));
  beside.wait();
  if (progress.is_cancelled()) return cancelled();  // the streams by the last that was heard
  return levels;
}

/// Has meshes keep their streams. One that is beyond a stream's limits goes without; its levels do not need it, unless
/// all but one are in it.
Result<void> keep_streams(const Scene& scene, const BuildOptions& options, MeshStreams streams,
                          std::vector<LeveledMesh>& levels, BuildResult& result, Notes& notes) {
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const std::string name = text("mesh '", scene.meshes()[i].name, "'");
    if (streams[i]) {
      result.meshes[i].stream.bytes = streams[i]->size();
      levels[i].stream = std::move(*streams[i]);
    } else if (!is_by_compact_streams(options.layout) && streams[i].error().code == ErrorCode::LimitExceeded) {
      notes.add(text(name, " has no removal stream: ", streams[i].error().message));
    } else {
      return fail(streams[i].error().code, text(name, ": ", streams[i].error().message));
    }
  }
  return {};
}

void report_layout(const AssetLayout& layout, std::size_t first, BuildResult& result) {
  for (std::size_t i = 0; i < layout.levels.size(); ++i)
    result.levels[first + i].bytes = layout.levels[i].geometry_bytes;
  result.stream.bytes += layout.stream_bytes;
  result.quantisation_error = std::max(result.quantisation_error, layout.quantisation_error);
  result.position_bits = std::max(result.position_bits, layout.position_bits);
}

void keep_levels(const std::vector<std::vector<AssetLevel>>& meshes, BuildResult& result) {
  result.decoded.resize(meshes.size());
  for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh)
    for (const AssetLevel& level : meshes[mesh]) result.decoded[mesh].levels.push_back(level);
}

/// Keeps the whole meshes as they are, where no file has them.
void keep_whole(const Scene& scene, BuildResult& result) {
  for (const SceneMesh& mesh : scene.meshes()) result.decoded.emplace_back().levels.emplace_back().mesh = mesh.mesh;
}

/// Encodes the levels that a file holds, measures them as they come out of it, and writes it with their numbers.
Result<void> make_file(MeasuredScene& measured, const LevelPlan& plan, const std::vector<LeveledMesh>& levels,
                       const BuildOptions& options, const FileLevels& file, BuildResult& result, Notes& notes,
                       const Progress& progress, BuildObserver& observer) {
  Stopwatch stopwatch;
  const Scene& scene = measured.scene();
  AssetOptions storage = storage_of(scene, options);
  storage.progress = progress.part(kEncodingShare);
  FileContent content;
  if (options.layout != FileLayout::OneFile) content.level = file.first;
  if (options.layout == FileLayout::FilePerLevel && !storage.gltf_name.empty())
    storage.gltf_name += text("_LOD", file.first);
  LODESTONE_TRY(EncodedGeometry geometry, encode_geometry(scene, levels, storage, content));
  result.timings_ms.write += stopwatch.lap_ms();
  LODESTONE_CHECK(measure_levels(measured, plan, options, file, geometry.levels(), result, observer));
  result.timings_ms.levels += stopwatch.lap_ms();
  if (options.keep_levels) keep_levels(geometry.levels(), result);
  LODESTONE_TRY(EncodedAsset asset, write_asset(std::move(geometry)));
  for (const std::string& note : asset.layout.notes) notes.add(note);
  report_layout(asset.layout, file.first, result);
  result.files.push_back(std::move(asset));
  result.timings_ms.write += stopwatch.lap_ms();
  if (!progress.reach(1)) return cancelled();
  return {};
}

/// Has a stream call materials as the options do.
void name_materials(const std::vector<Index>& numbers, ProgressiveMesh& mesh) {
  for (FaceGroup& group : mesh.groups)
    if (group.material < numbers.size()) group.material = numbers[group.material];
}

/// The primitive that a material so called is of.
Index primitive_of(Index material, const std::vector<Index>& numbers) {
  const auto found = std::find(numbers.begin(), numbers.end(), material);
  return found == numbers.end() ? material : static_cast<Index>(found - numbers.begin());
}

/// The last of a stream's positions with at most so many faces.
Index position_of_faces(const std::vector<Index>& counts, std::size_t face_count) {
  std::size_t position = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] <= face_count) position = i;
  return static_cast<Index>(position);
}

/// How many bytes of a stream lead to a position.
std::uint64_t bytes_up_to(std::span<const std::byte> stream, Index position) {
  const auto chunks = read_compact_chunks(stream);
  if (!chunks) return 0;
  std::uint64_t end = 0;
  for (const CompactChunk& chunk : *chunks) {
    end = chunk.byte_offset + chunk.byte_length;
    if (chunk.record_begin + chunk.record_count >= position) break;
  }
  return end;
}

/// Makes the stream of `FileLayout::StreamAlone` the only file, and measures the levels as it leads to them: records of
/// a round have another order there, so that a level between two rounds is not quite the one that was planned.
Result<void> make_stream_file(MeasuredScene& measured, const LevelPlan& plan, std::vector<LeveledMesh>& levels,
                              const BuildOptions& options, BuildResult& result, BuildObserver& observer) {
  Stopwatch stopwatch;
  const SceneMesh& mesh = measured.scene().meshes()[0];
  std::vector<std::byte>& stream = levels[0].stream;
  LODESTONE_TRY(ProgressiveMesh decoded, read_stream(stream));
  for (FaceGroup& group : decoded.groups) group.material = primitive_of(group.material, options.material_numbers);
  const std::vector<Index> counts = face_counts(decoded);
  std::vector<std::vector<AssetLevel>> found(1);
  for (std::size_t i = 0; i < plan.level_count(); ++i) {
    const Index position = position_of_faces(counts, levels[0].levels[i].mesh.face_count());
    AssetLevel& level = found[0].emplace_back(std::move(levels[0].levels[i]));
    level.mesh = extract_level(decoded, position);
    const auto bound = static_cast<double>(decoded.deviation[position]);
    BuildResult::Level& reported = result.levels[i];
    reported.face_count = result.meshes[0].levels[i].face_count = level.mesh.face_count();
    reported.deviation_bound = bound * mesh.scale;
    reported.curvature_error = static_cast<double>(decoded.curvature_error[position]);
    reported.bytes = bytes_up_to(stream, position);
    result.meshes[0].levels[i].deviation_bound = bound;
  }
  LODESTONE_CHECK(measure_levels(measured, plan, options, {0, 1, 0}, found, result, observer));
  if (options.keep_levels) keep_levels(found, result);
  const CompactOptions compact = stream_options(measured.scene(), options)[0];
  if (!compact.lossless) result.position_bits = compact.grid_bits;
  if (compact.grid && !compact.lossless)  // half the diagonal of a step
    result.quantisation_error = std::sqrt(0.75) * static_cast<double>(compact.grid->range) /
                                static_cast<double>((1 << compact.grid_bits) - 1) * mesh.scale;
  result.stream.bytes = stream.size();
  EncodedAsset file;
  file.layout.stream_bytes = file.layout.total_bytes = stream.size();
  file.glb = std::move(stream);
  result.files.push_back(std::move(file));
  result.timings_ms.levels += stopwatch.lap_ms();
  return {};
}

/// What streams lead to in the end, measured as they are decoded.
Result<void> measure_refined(MeasuredScene& measured, const LevelPlan& plan, const std::vector<LeveledMesh>& levels,
                             const BuildOptions& options, BuildResult& result, BuildObserver& observer) {
  Stopwatch stopwatch;
  std::vector<std::vector<AssetLevel>> whole(levels.size());
  std::vector<Result<ProgressiveMesh>> decoded(levels.size());
  for_each_in_parallel(levels.size(), [&](std::size_t i) {
    decoded[i] = read_stream(levels[i].stream);
    whole[i].resize(1);
    if (decoded[i]) whole[i][0].mesh = extract_level(*decoded[i], kNoIndex);
  });
  for (const Result<ProgressiveMesh>& mesh : decoded)
    if (!mesh) return tl::unexpected(mesh.error());
  LODESTONE_CHECK(measure_levels(measured, plan, options, {0, plan.level_count(), 0}, whole, result, observer));
  if (options.keep_levels) keep_levels(whole, result);
  result.timings_ms.levels += stopwatch.lap_ms();
  return {};
}

/// Writes the file of `FileLayout::Refined`, after measuring what it does not show at first.
Result<void> make_refined_file(MeasuredScene& measured, const LevelPlan& plan, const std::vector<LeveledMesh>& levels,
                               const BuildOptions& options, BuildResult& result, Notes& notes, const Progress& progress,
                               BuildObserver& observer) {
  const std::size_t count = plan.level_count(), shown = count - 1;
  if (shown > 0) LODESTONE_CHECK(measure_refined(measured, plan, levels, options, result, observer));
  LODESTONE_CHECK(make_file(measured, plan, levels, options, {shown, count, shown}, result, notes, progress, observer));
  if (shown > 0) result.levels[0].bytes = result.stream.bytes;
  return {};
}

Result<void> check_options(const BuildOptions& options) {
  if (options.effort < kLeastEffort || options.effort > kMostEffort)
    return fail(ErrorCode::InvalidArgument,
                text("effort is ", options.effort, ", not from ", kLeastEffort, " to ", kMostEffort));
  if (options.limit && (options.limit->kind != TargetKind::Error || has_error_targets(options)))
    return fail(ErrorCode::InvalidArgument, "a limit is an error, where targets are of faces or epsilon");
  if (options.layout == FileLayout::Refined && options.targets.size() > 1)
    return fail(ErrorCode::InvalidArgument,
                text(options.targets.size(), " targets, where the file shows one level and streams the others"));
  if (options.layout == FileLayout::OneLevel && options.targets.size() != 1)
    return fail(ErrorCode::InvalidArgument, text(options.targets.size(), " targets, where the file has one level"));
  if (!is_by_compact_streams(options.layout)) return {};
  if (options.storage.position_grid)
    return fail(ErrorCode::Unsupported, "a grid of a given step, which compact streams do not have");
  if (const auto& bits = options.storage.position_bits; bits && (*bits < kLeastGridBits || *bits > kMostGridBits))
    return fail(ErrorCode::InvalidArgument,
                text("positions of ", *bits, " bits, where streams have ", kLeastGridBits, " to ", kMostGridBits));
  return {};
}

}  // namespace

Result<BuildResult> build_asset(const Scene& scene, const BuildOptions& given, BuildObserver& observer) {
  BuildOptions options = given;
  BuildResult result;
  Notes notes(result, observer);
  Stopwatch stopwatch;
  LODESTONE_CHECK(check_options(options));
  LODESTONE_CHECK(check_names(options.importance, scene));
  LODESTONE_CHECK(sort_finest_first(options.targets, scene));
  if (options.layout == FileLayout::StreamAlone) {
    if (scene.meshes().size() != 1)
      return fail(ErrorCode::InvalidArgument, text("a stream alone is of one mesh, not of ", scene.meshes().size()));
    options.placement = Placement::Subset;
  }

  LODESTONE_TRY(result.simplified, simplify_scene(scene, options, observer));
  report_streams(scene, result);
  result.timings_ms.simplify = stopwatch.lap_ms();

  SceneFitter fitter(scene, result.simplified, options);
  MeasuredScene measured(scene);
  const Progress making = stage_progress(observer, BuildStage::MakingLevels);
  LevelPlan plan = plan_levels(measured, result.simplified, options, fitter, making.part(0));
  Result<MeshStreams> streams;
  LODESTONE_TRY(std::vector<LeveledMesh> levels,
                make_levels_and_streams(measured, result, plan, options, fitter, streams, making));
  if (options.layout == FileLayout::Refined) {
    for (std::size_t i = 0; i < levels.size(); ++i)
      keep_every_material(scene.meshes()[i].mesh, levels[i].levels.back().mesh);
  }
  report_plan(scene, plan, levels, result);
  result.timings_ms.levels = stopwatch.lap_ms();
  if (options.strict && !result.met) return result;

  const Progress writing = stage_progress(observer, BuildStage::Writing);
  if (options.layout == FileLayout::StreamAlone) name_materials(options.material_numbers, result.simplified[0].mesh);
  if (is_by_compact_streams(options.layout)) {
    const bool places = given.placement == Placement::Optimised;
    const StreamPlacer placer = {measured, fitter};
    streams =
        encode_streams(scene, result.simplified, options, places ? &placer : nullptr, writing.part(kStreamsShare));
  }
  if (!streams) return tl::unexpected(streams.error());
  LODESTONE_CHECK(keep_streams(scene, options, std::move(*streams), levels, result, notes));
  if (options.layout == FileLayout::Refined && options.targets.size() == 1 && options.targets[0].is_wish) {
    LODESTONE_TRY(const bool is_coarser,
                  fit_first_picture(measured, result.simplified, options, fitter, writing.part(0), plan, levels));
    if (is_coarser) report_last_level_again(scene, plan, levels, result);
  }
  writing.reach(kStreamsShare);
  result.timings_ms.write = stopwatch.lap_ms();
  if (options.layout == FileLayout::StreamAlone) {
    LODESTONE_CHECK(make_stream_file(measured, plan, levels, options, result, observer));
    if (!writing.reach(1)) return cancelled();
    return result;
  }
  if (options.layout == FileLayout::Refined) {
    LODESTONE_CHECK(
        make_refined_file(measured, plan, levels, options, result, notes, writing.part(1 - kStreamsShare), observer));
    return result;
  }
  const std::size_t first = options.layout == FileLayout::OneLevel ? plan.level_count() - 1 : 0;
  if (first > 0 && options.keep_levels) keep_whole(scene, result);
  const std::size_t file_count = options.layout == FileLayout::FilePerLevel ? plan.level_count() : 1;
  const double share = (1 - kStreamsShare) / static_cast<double>(file_count);
  for (std::size_t i = 0; i < file_count; ++i)
    LODESTONE_CHECK(make_file(measured, plan, levels, options, {i, file_count, first + i}, result, notes,
                              writing.part(share), observer));
  return result;
}

Result<BuildResult> build_asset(const Scene& scene, const BuildOptions& options) {
  BuildObserver unobserved;
  return build_asset(scene, options, unobserved);
}

}  // namespace lodestone

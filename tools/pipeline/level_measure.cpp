#include "pipeline/level_measure.h"

#include <algorithm>

#include <lodestone/core/parallel.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/deviation.h>

#include "pipeline/build_progress.h"
#include "pipeline/deviation_total.h"

namespace lodestone::detail {
namespace {

constexpr double kDistancesShare = 0.9;  // of the work; attributes are the rest
constexpr double kLeastShare = 0.02;     // Of the samples for one mesh: its own numbers need some, too.

/// How much of a scene's samples a mesh gets, by its faces: many small meshes cost little more than one large one.
double share_of_samples(const Scene& scene, const Mesh& mesh) {
  std::size_t all = 0;
  for (const SceneMesh& other : scene.meshes()) all += other.mesh.face_count();
  return std::max(static_cast<double>(mesh.face_count()) / static_cast<double>(all), kLeastShare);
}

std::size_t part_of(std::size_t sample_count, double share) {
  return static_cast<std::size_t>(share * static_cast<double>(sample_count));
}

DeviationOptions level_measure(const BuildEffort& effort, const Progress& progress, double share = 1) {
  DeviationOptions options;
  options.progress = progress;
  options.sample_count = part_of(effort.distance_samples, share);
  options.relative_tolerance = effort.tolerance;
  options.each_way = false;
  return options;
}

void measure_level(const Scene& scene, const MeasuredSurface& original, const Mesh& level, const BuildEffort& effort,
                   const Progress& progress, BuildResult::MeshPart::Level& reported) {
  const Mesh& whole = original.mesh();
  reported.vertex_count = level.vertex_count();
  if (!progress.add(0)) return;  // preparing both takes long enough
  const MeasuredSurface surface(level);
  if (!progress.add(0)) return;
  const double share = share_of_samples(scene, whole);
  reported.deviation =
      measure_deviation(original, surface, level_measure(effort, progress.part(kDistancesShare), share));
  reported.attributes =
      measure_attributes(whole, surface, part_of(effort.attribute_samples, share), progress.part(1 - kDistancesShare));
}

/// Adds up what the meshes' levels deviate.
void total_level(const Scene& scene, std::size_t number, BuildResult& result) {
  DeviationTotal total;
  std::size_t vertex_count = 0;
  for (std::size_t i = 0; i < result.meshes.size(); ++i) {
    const SceneMesh& mesh = scene.meshes()[i];
    const BuildResult::MeshPart::Level& level = result.meshes[i].levels[number];
    total.add(level.deviation, mesh.scale, mesh.area);
    vertex_count += level.vertex_count * mesh.instance_count;
  }
  result.levels[number].vertex_count = vertex_count;
  result.levels[number].deviation = total.result();
}

}  // namespace

bool lies_within(const MeasuredSurface& a, const Mesh& b, double limit, const BuildEffort& effort,
                 const Progress& progress) {
  return measure_maximum(a, MeasuredSurface(b), level_measure(effort, progress), limit).maximum_bound() <= limit;
}

double measured_maximum(const MeasuredSurface& a, const Mesh& b, const BuildEffort& effort, const Progress& progress) {
  return measure_maximum(a, MeasuredSurface(b), level_measure(effort, progress)).maximum_bound();
}

Result<void> measure_levels(MeasuredScene& measured, const LevelPlan& plan, const BuildOptions& options,
                            const FileLevels& file, std::vector<std::vector<AssetLevel>>& meshes, BuildResult& result,
                            BuildObserver& observer) {
  const Scene& scene = measured.scene();
  const std::size_t count = meshes.front().size();
  const auto files = static_cast<double>(file.file_count), number_of_file = static_cast<double>(file.file);
  const Progress progress =
      stage_progress(observer, BuildStage::MeasuringLevels, number_of_file / files, (number_of_file + 1) / files);
  const double share = 1 / static_cast<double>(meshes.size() * count);
  for_each_in_parallel(meshes.size() * count, [&](std::size_t i) {
    const std::size_t mesh = i / count, level = i % count, number = file.first + level;
    if (progress.is_cancelled()) return;
    const Progress part = progress.part(share);
    const bool is_as_it_was = options.storage.compression == Compression::None &&
                              !is_by_compact_streams(options.layout) && is_whole(plan, result.simplified, mesh, number);
    if (!is_as_it_was && (level == 0 || !plan.repeats(mesh, number)))
      measure_level(scene, measured.original(mesh), meshes[mesh][level].mesh, build_effort(options.effort), part,
                    result.meshes[mesh].levels[number]);
    part.reach(1);
  });
  if (!progress.reach(1)) return cancelled();
  for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh)
    for (std::size_t level = 0; level < count; ++level) {
      const std::size_t number = file.first + level;
      std::vector<BuildResult::MeshPart::Level>& reported = result.meshes[mesh].levels;
      if (level > 0 && plan.repeats(mesh, number)) reported[number] = reported[number - 1];
      meshes[mesh][level].deviation = reported[number].deviation;
    }
  for (std::size_t level = 0; level < count; ++level) total_level(scene, file.first + level, result);
  return {};
}

}  // namespace lodestone::detail

#include "pipeline/make_levels.h"

#include <utility>

#include <lodestone/core/parallel.h>
#include <lodestone/lod/cursor.h>

#include "pipeline/build_progress.h"
#include "pipeline/level_measure.h"

namespace lodestone::detail {
namespace {

/// What one level of one mesh is made of.
struct LevelSource {
  const SimplifyResult& simplified;
  const SceneChoice& choice;
  std::size_t mesh = 0;
  bool by_error = false;  ///< it keeps to one
  Progress progress;
};

/// Says in a level why it is no coarser.
void state_why(const SceneChoice& choice, std::size_t mesh, AssetLevel& level) {
  level.stop_reason = choice.stopped_by;
  level.deviation_beyond = choice.beyond.empty() ? 0 : choice.beyond[mesh];
}

AssetLevel make_level(const LevelSource& source, MeasuredScene& measured, SceneFitter& fitter) {
  const Index position = source.choice.positions[source.mesh];
  const ProgressiveMesh& progressive = source.simplified.mesh;
  AssetLevel level;
  level.curvature_error = progressive.curvature_error[position];
  state_why(source.choice, source.mesh, level);
  level.mesh = extract_level(progressive, position);
  if (!fitter.fits(source.mesh) || position == progressive.record_count()) return level;
  Mesh fitted = fitter.fitted(source.mesh, level.mesh, source.progress);
  const double bound = static_cast<double>(progressive.deviation[position]);
  if (!source.by_error || lies_within(measured.original(source.mesh), fitted, bound, fitter.effort(), source.progress))
    level.mesh = std::move(fitted);
  return level;
}

}  // namespace

Result<std::vector<LeveledMesh>> make_levels(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                                             const LevelPlan& plan, SceneFitter& fitter, const Progress& progress) {
  const std::size_t count = plan.level_count();
  std::vector<LeveledMesh> meshes(simplified.size());
  for (LeveledMesh& mesh : meshes) mesh.levels.resize(count);
  const double share = 1 / static_cast<double>(meshes.size() * count);
  for_each_in_parallel(meshes.size() * count, [&](std::size_t i) {
    const std::size_t mesh = i / count, level = i % count;
    if (progress.is_cancelled()) return;
    const Progress part = progress.part(share);
    if (!plan.repeats(mesh, level))
      meshes[mesh].levels[level] =
          make_level({simplified[mesh], plan.choices[level], mesh, plan.by_error, part}, measured, fitter);
    part.reach(1);
  });
  if (!progress.reach(1)) return cancelled();
  for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh)
    for (std::size_t level = 1; level < count; ++level) {
      if (!plan.repeats(mesh, level)) continue;
      meshes[mesh].levels[level] = meshes[mesh].levels[level - 1];
      state_why(plan.choices[level], mesh, meshes[mesh].levels[level]);
    }
  return meshes;
}

}  // namespace lodestone::detail

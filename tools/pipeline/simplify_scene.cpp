#include "pipeline/simplify_scene.h"

#include <algorithm>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>

#include "pipeline/build_effort.h"
#include "pipeline/build_progress.h"
#include "pipeline/level_plan.h"

namespace lodestone::detail {
namespace {

constexpr double kMostFacesOfOneRemoval = 2;

/// Where to stop: at the base mesh for the stream's sake; without a stream once the coarsest level is surely reached.
/// Only face counts of the mesh itself can tell early: what errors are, and what is left for a mesh of what a scene may
/// have, is settled when the whole run is known.
StopCriteria stop_criteria(const Scene& scene, const SceneMesh& mesh, const BuildOptions& options) {
  StopCriteria stop;
  const bool is_alone = options.scope == TargetScope::Mesh || (scene.meshes().size() == 1 && mesh.instance_count == 1);
  if (writes_streams(options) || !is_alone || options.targets.empty() ||
      options.targets.back().kind != TargetKind::Faces)
    return stop;
  const LevelTarget coarsest = resolve(options.targets.back(), {mesh.mesh.face_count(), 0});
  stop.min_faces = static_cast<std::size_t>(std::max(0.0, coarsest.value - kMostFacesOfOneRemoval));
  return stop;
}

Result<SimplifyOptions> options_for(const Scene& scene, const SceneMesh& mesh, const BuildOptions& build) {
  SimplifyOptions options = build.simplify;
  options.effort = build.effort;
  options.measure_step = build_effort(build.effort).measure_step;
  if (is_by_compact_streams(build.layout)) options.dense_rounds = kStreamDenseRounds;
  options.stop = stop_criteria(scene, mesh, build);
  options.weights.target_reach = mesh.target_reach;
  LODESTONE_TRY(options.importance, vertex_importance(mesh, build.importance));
  // Bounds of every record are for the stream, for levels by error, and for sharing faces among meshes.
  const bool is_shared = scene.meshes().size() > 1 && build.scope == TargetScope::Scene;
  if (!writes_streams(build) && !is_by_error(build) && !is_shared) options.measure_step = 0;
  return options;
}

Result<SimplifyResult> simplify_mesh(const Scene& scene, std::size_t mesh, const BuildOptions& build,
                                     const Progress& progress) {
  LODESTONE_TRY(SimplifyOptions options, options_for(scene, scene.meshes()[mesh], build));
  options.progress = progress;
  return simplify(scene.meshes()[mesh].mesh, options);
}

}  // namespace

bool writes_streams(const BuildOptions& options) {
  return is_by_compact_streams(options.layout) || (options.stream && options.layout == FileLayout::OneFile);
}

Result<std::vector<SimplifyResult>> simplify_scene(const Scene& scene, const BuildOptions& options,
                                                   BuildObserver& observer) {
  const std::vector<SceneMesh>& meshes = scene.meshes();
  double face_count = 0;
  for (const SceneMesh& mesh : meshes) face_count += static_cast<double>(mesh.mesh.face_count());
  const Progress progress = stage_progress(observer, BuildStage::Simplifying);
  std::vector<Result<SimplifyResult>> results(meshes.size());
  for_each_in_parallel(meshes.size(), [&](std::size_t i) {
    const double share = static_cast<double>(meshes[i].mesh.face_count()) / face_count;
    if (!progress.is_cancelled()) results[i] = simplify_mesh(scene, i, options, progress.part(share));
  });
  if (!progress.reach(1)) return cancelled();
  std::vector<SimplifyResult> simplified;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (!results[i])
      return fail(results[i].error().code, text("mesh '", meshes[i].name, "': ", results[i].error().message));
    simplified.push_back(std::move(*results[i]));
  }
  return simplified;
}

}  // namespace lodestone::detail

#include "pipeline/level_plan.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include <lodestone/lod/cursor.h>

#include "pipeline/build_effort.h"
#include "pipeline/level_measure.h"

namespace lodestone::detail {
namespace {

constexpr double kQuantisationShare = 0.1;  // of an error that a level may have
constexpr double kBoxGrowth = 1.05;         // fitted vertices may lie a little outside of the box that grids span

/// The smallest error that a level may have, world units; infinite where levels are not by error.
double smallest_error(const Scene& scene, const BuildOptions& options) {
  double smallest = std::numeric_limits<double>::infinity();
  std::vector<LevelTarget> targets = options.targets;
  if (options.limit) targets.push_back(*options.limit);
  for (const LevelTarget& target : targets) {
    if (target.kind != TargetKind::Error) continue;
    if (!target.relative || options.scope == TargetScope::Scene)
      smallest = std::min(smallest, resolve(target, {0, scene.box().diagonal()}).value);
    else
      for (const SceneMesh& mesh : scene.meshes())
        smallest = std::min(smallest, target.value * bounding_box(mesh.mesh).diagonal() * mesh.scale);
  }
  return smallest;
}

/// What was charged for each position, in world units; angles know no units.
std::vector<double> world_charges(const SimplifyResult& result, Metric metric, double scale) {
  std::vector<double> charges(result.charge.begin(), result.charge.end());
  if (metric != Metric::Gaussian)
    for (double& charge : charges) charge *= scale;
  return charges;
}

/// What a level at a position really deviates by, in mesh units, but for quantisation.
double measured_error(MeasuredScene& measured, const SimplifyResult& simplified, Index position, std::size_t mesh,
                      SceneFitter& fitter, const Progress& progress) {
  Mesh level = extract_level(simplified.mesh, position);
  if (fitter.fits(mesh)) level = fitter.fitted(mesh, level, progress);
  return measured_maximum(measured.original(mesh), level, fitter.effort(), progress);
}

/// Returns what measures a mesh's levels, each once: all targets ask for the same ones.
std::function<double(Index)> error_meter(MeasuredScene& measured, const SimplifyResult& simplified, std::size_t mesh,
                                         SceneFitter& fitter, const Progress& progress) {
  return [&, mesh, errors = std::map<Index, double>()](Index position) mutable {
    const auto [found, is_new] = errors.try_emplace(position);
    if (is_new) found->second = measured_error(measured, simplified, position, mesh, fitter, progress);
    return found->second;
  };
}

/// A stream alone has levels as it bounds them.
int probe_count(const BuildOptions& options) {
  return options.layout == FileLayout::StreamAlone ? 0 : build_effort(options.effort).probe_count;
}

/// What they hold looks at the scene, the streams and the options.
std::vector<ScenePart> parts_of(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                                const BuildOptions& options, SceneFitter& fitter, const Progress& progress) {
  const Scene& scene = measured.scene();
  const std::vector<double> displacements = quantisation_errors(scene, storage_of(scene, options));
  std::vector<ScenePart> parts;
  for (std::size_t i = 0; i < simplified.size(); ++i) {
    const SceneMesh& mesh = scene.meshes()[i];
    parts.push_back({&simplified[i].mesh, mesh.scale, mesh.instance_count, simplified[i].stop_reason,
                     importance_of(mesh, options.importance),
                     world_charges(simplified[i], options.simplify.metric, mesh.scale),
                     error_meter(measured, simplified[i], i, fitter, progress), probe_count(options),
                     kBoxGrowth * displacements[i]});
  }
  return parts;
}

SceneChoice whole_scene(const std::vector<SimplifyResult>& simplified) {
  SceneChoice choice{{}, {}, true, "whole", {}};
  for (const SimplifyResult& result : simplified)
    choice.positions.push_back(static_cast<Index>(result.mesh.record_count()));
  return choice;
}

}  // namespace

bool has_error_targets(const BuildOptions& options) {
  return !options.targets.empty() && options.targets.back().kind == TargetKind::Error;
}

bool is_by_error(const BuildOptions& options) { return options.limit || has_error_targets(options); }

bool is_whole(const LevelPlan& plan, const std::vector<SimplifyResult>& simplified, std::size_t mesh,
              std::size_t level) {
  return plan.choices[level].positions[mesh] == simplified[mesh].mesh.record_count();
}

bool is_met(const LevelPlan& plan) {
  const auto met = [](const auto& entry) { return entry.met; };
  return std::all_of(plan.choices.begin(), plan.choices.end(), met) &&
         std::all_of(plan.left_out.begin(), plan.left_out.end(), met);
}

LevelPlan plan_levels(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                      const BuildOptions& options, SceneFitter& fitter, const Progress& progress) {
  const Scene& scene = measured.scene();
  const std::vector<ScenePart> parts = parts_of(measured, simplified, options, fitter, progress);
  LevelPlan plan{{whole_scene(simplified)}, {}, 0, is_by_error(options)};
  for (const ScenePart& part : parts) plan.grid_error = std::max(plan.grid_error, part.displacement * part.scale);
  for (const LevelTarget& target : options.targets) {
    SceneChoice choice = choose_positions(parts, target, options.scope, scene.box().diagonal());
    if (options.limit) keep_within(parts, *options.limit, options.scope, scene.box().diagonal(), choice);
    const std::vector<Index>& before = plan.choices.back().positions;
    for (std::size_t i = 0; i < before.size() && !choice.met; ++i)
      choice.positions[i] = std::min(choice.positions[i], before[i]);
    if (choice.positions == before)
      plan.left_out.push_back(
          {choice.target, choice.met, choice.stopped_by, world_beyond(scene, choice), plan.level_count() - 1});
    else
      plan.choices.push_back(std::move(choice));
  }
  return plan;
}

Result<void> sort_finest_first(std::vector<LevelTarget>& targets, const Scene& scene) {
  FullSize full{0, scene.box().diagonal()};
  for (const SceneMesh& mesh : scene.meshes()) full.face_count += mesh.mesh.face_count() * mesh.instance_count;
  for (const LevelTarget& target : targets)
    if (target.kind != targets.front().kind)
      return fail(ErrorCode::InvalidArgument, "the targets of a build are all of one kind: faces, error or epsilon");
  std::stable_sort(targets.begin(), targets.end(), [&](const LevelTarget& a, const LevelTarget& b) {
    const double first = resolve(a, full).value, second = resolve(b, full).value;
    return a.kind == TargetKind::Faces ? first > second : first < second;
  });
  return {};
}

AssetOptions storage_of(const Scene& scene, const BuildOptions& options) {
  AssetOptions storage = options.storage;
  storage.keep_decoded = true;
  storage.position_error = std::min(storage.position_error, kQuantisationShare * smallest_error(scene, options));
  return storage;
}

double world_beyond(const Scene& scene, const SceneChoice& choice) {
  double largest = 0;
  for (std::size_t i = 0; i < choice.beyond.size(); ++i)
    largest = std::max(largest, choice.beyond[i] * scene.meshes()[i].scale);
  return largest;
}

}  // namespace lodestone::detail

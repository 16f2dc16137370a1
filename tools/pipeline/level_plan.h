#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/io/scene.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_asset.h>

#include "pipeline/measured_scene.h"
#include "pipeline/scene_fitter.h"

namespace lodestone::detail {

/// Which position of each mesh's stream is its level, for all levels.
struct LevelPlan {
  std::vector<SceneChoice> choices;  ///< by level; the first is the whole scene
  std::vector<BuildResult::LeftOut> left_out;
  double grid_error = 0;  ///< see `BuildResult`
  bool by_error = false;  ///< levels keep to an error, theirs or a limit

  std::size_t level_count() const { return choices.size(); }
  /// Whether a mesh's level is the one before.
  bool repeats(std::size_t mesh, std::size_t level) const {
    return level > 0 && choices[level].positions[mesh] == choices[level - 1].positions[mesh];
  }
};

/// Whether a plan's level of a mesh is all of it.
bool is_whole(const LevelPlan& plan, const std::vector<SimplifyResult>& simplified, std::size_t mesh,
              std::size_t level);

/// Whether levels answer all targets.
bool is_met(const LevelPlan& plan);

/// Finds each mesh's positions: the whole scene, then what answers the targets, within the limit. What would repeat the
/// level before is left out.
LevelPlan plan_levels(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                      const BuildOptions& options, SceneFitter& fitter, const Progress& progress);

/// Whether targets are errors.
bool has_error_targets(const BuildOptions& options);

/// Whether levels keep to an error: their own, or one that limits them all.
bool is_by_error(const BuildOptions& options);

/// Sorts targets of one kind: finest first, by what they come to for the whole scene. Errors: InvalidArgument for
/// several kinds.
Result<void> sort_finest_first(std::vector<LevelTarget>& targets, const Scene& scene);

/// Returns how the levels are stored: of an error that is asked for, quantisation may take its share.
AssetOptions storage_of(const Scene& scene, const BuildOptions& options);

/// What faces asked for would have cost, in world units; 0 where no error stopped the level before them.
double world_beyond(const Scene& scene, const SceneChoice& choice);

}  // namespace lodestone::detail

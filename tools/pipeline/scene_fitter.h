#pragma once

#include <vector>

#include <lodestone/io/scene.h>
#include <lodestone/lod/place_levels.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_options.h>

#include "pipeline/build_effort.h"
#include "pipeline/on_first_use.h"

namespace lodestone::detail {

/// Fits levels of a scene's meshes, from several threads if wanted; prepares a mesh when its first level comes.
class SceneFitter {
 public:
  /// All outlive it.
  SceneFitter(const Scene& scene, const std::vector<SimplifyResult>& simplified, const BuildOptions& options);

  /// Whether a mesh's levels are fitted to it. Vertices of skinned and morphed meshes take their weights and targets
  /// with them, so those stay where they are.
  bool fits(std::size_t mesh) const;

  const BuildEffort& effort() const { return build_effort(options_.effort); }

  /// Returns a level of a mesh fitted to it, all but the vertices that the options kept.
  Mesh fitted(std::size_t mesh, const Mesh& level, const Progress& progress);

  /// Returns levels of a mesh's stream placed closer to it; none where its vertices stay. `whole`: of the mesh.
  std::vector<PlacedLevel> placed(std::size_t mesh, const MeasuredSurface& whole, const Progress& progress);

 private:
  bool may_move(std::size_t mesh) const;
  const LevelFitter& fitter(std::size_t mesh, const Progress& progress);
  PlacementOptions options_of(std::size_t mesh, const Progress& progress) const;

  const Scene& scene_;
  const std::vector<SimplifyResult>& simplified_;
  const BuildOptions& options_;
  std::vector<OnFirstUse<LevelFitter>> fitters_;  // by mesh
};

}  // namespace lodestone::detail

#include "pipeline/scene_fitter.h"

namespace lodestone::detail {

SceneFitter::SceneFitter(const Scene& scene, const std::vector<SimplifyResult>& simplified, const BuildOptions& options)
    : scene_(scene), simplified_(simplified), options_(options), fitters_(simplified.size()) {}

bool SceneFitter::may_move(std::size_t mesh) const {
  const SceneMesh& whole = scene_.meshes()[mesh];
  return !whole.skinned && !whole.has_targets;
}

bool SceneFitter::fits(std::size_t mesh) const { return options_.placement == Placement::Optimised && may_move(mesh); }

const LevelFitter& SceneFitter::fitter(std::size_t mesh, const Progress& progress) {
  return fitters_[mesh].get([&] { return LevelFitter(scene_.meshes()[mesh].mesh, progress.part(0)); });
}

PlacementOptions SceneFitter::options_of(std::size_t mesh, const Progress& progress) const {
  PlacementOptions placement;
  placement.effort = options_.effort;
  placement.fixed = simplified_[mesh].locked;
  placement.progress = progress;
  return placement;
}

Mesh SceneFitter::fitted(std::size_t mesh, const Mesh& level, const Progress& progress) {
  return fitter(mesh, progress).fit(level, options_of(mesh, progress));
}

std::vector<PlacedLevel> SceneFitter::placed(std::size_t mesh, const MeasuredSurface& whole, const Progress& progress) {
  if (!may_move(mesh)) return {};
  return place_levels(fitter(mesh, progress), whole, simplified_[mesh].mesh, options_of(mesh, progress));
}

}  // namespace lodestone::detail

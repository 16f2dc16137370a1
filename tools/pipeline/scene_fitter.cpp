#include "pipeline/scene_fitter.h"

namespace lodestone::detail {

SceneFitter::SceneFitter(const Scene& scene, const std::vector<SimplifyResult>& simplified, const BuildOptions& options)
    : scene_(scene), simplified_(simplified), options_(options), fitters_(simplified.size()) {}

bool SceneFitter::fits(std::size_t mesh) const {
  const SceneMesh& whole = scene_.meshes()[mesh];
  return options_.placement == Placement::Optimised && !whole.skinned && !whole.has_targets;
}

Mesh SceneFitter::fitted(std::size_t mesh, const Mesh& level, const Progress& progress) {
  PlacementOptions placement;
  placement.effort = options_.effort;
  placement.fixed = simplified_[mesh].locked;
  placement.progress = progress;
  const auto make = [&] { return LevelFitter(scene_.meshes()[mesh].mesh, progress.part(0)); };
  return fitters_[mesh].get(make).fit(level, placement);
}

}  // namespace lodestone::detail

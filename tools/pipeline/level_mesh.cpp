#include "pipeline/level_mesh.h"

#include <lodestone/lod/placement.h>

namespace lodestone::detail {

bool fits_levels(const SceneMesh& mesh, const BuildOptions& options) {
  return options.placement == Placement::Optimised && !mesh.skinned && !mesh.has_targets;
}

Mesh fitted_level(const SceneMesh& mesh, const SimplifyResult& simplified, const Mesh& level) {
  PlacementOptions placement;
  placement.fixed = simplified.locked;
  return optimise_placement(mesh.mesh, level, placement);
}

}  // namespace lodestone::detail

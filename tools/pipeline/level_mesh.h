#pragma once

#include <lodestone/io/scene.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_options.h>

namespace lodestone::detail {

/// Whether a mesh's levels are fitted to it. Vertices of skinned and morphed meshes take their weights and targets with
/// them, so those stay where they are.
bool fits_levels(const SceneMesh& mesh, const BuildOptions& options);

/// Returns a level of a mesh fitted to it, all but the vertices that the options kept.
Mesh fitted_level(const SceneMesh& mesh, const SimplifyResult& simplified, const Mesh& level);

}  // namespace lodestone::detail

#pragma once

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/lod/simplify_options.h>

namespace lodestone::detail {

/// Marks the edges that removals are to keep as lines though the wedges on their two sides agree: hard edges by angle,
/// where the options ask for them, and edges across which a texture is mirrored.
void mark_creases(const Mesh& mesh, const SimplifyOptions& options, Connectivity& connectivity);

}  // namespace lodestone::detail

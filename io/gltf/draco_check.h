#pragma once

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "gltf/draco_decode.h"
#include "gltf/draco_encode.h"

namespace lodestone::detail {

/// Tells whether Draco data holds what went into it: all faces, and values that are where they were but for their
/// grids' steps. Draco has an order of its own, so that it is sums over all corners that are compared.
/// Pre: `decoded` has positions and then the mesh's attributes. Errors: Unsupported, naming what came out otherwise.
Result<void> check_decoded(const DracoGeometry& decoded, const Mesh& mesh, const QuantizationGrids& grids);

}  // namespace lodestone::detail

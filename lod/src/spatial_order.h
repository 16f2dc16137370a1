#pragma once

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns the same mesh with vertices, wedges and faces along a space-filling curve, so that what is close on the
/// surface is close in memory; what no face uses is left out. Deterministic.
Mesh in_spatial_order(const Mesh& mesh);

}  // namespace lodestone::detail

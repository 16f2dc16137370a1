#pragma once

#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns the same mesh with vertices, wedges and faces along a space-filling curve, so that what is close on the
/// surface is close in memory; what no face uses is left out. `source_vertex`
/// gets, for each vertex, its number in `mesh`. Deterministic.
Mesh in_spatial_order(const Mesh& mesh, std::vector<Index>& source_vertex);

}  // namespace lodestone::detail

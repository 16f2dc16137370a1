#pragma once

#include <lodestone/core/mesh.h>
#include <lodestone/io/compact_stream.h>

namespace lodestone::bench {

/// Bits of a mesh by meshoptimizer's codecs for vertices and indices and zstd's highest ordinary level over both, on
/// the grid and at the bits that the options say: faces and wedges in the order of its optimisers, an array for each
/// attribute. Pre: the options name a grid.
double meshopt_bits(const Mesh& mesh, const CompactOptions& options);

}  // namespace lodestone::bench

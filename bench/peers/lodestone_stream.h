#pragma once

#include <lodestone/lod/simplify.h>

#include "simplifier.h"

namespace lodestone::bench {

/// Simplifies to the base mesh once and takes every level out of the stream: each has the time of the whole.
std::vector<Level> lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts,
                                    SimplifyOptions options);

}  // namespace lodestone::bench

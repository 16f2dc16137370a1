#pragma once

#include <cstddef>

#include <lodestone/core/assemble.h>

namespace lodestone::bench {

/// Returns a torus of about so many triangles whose surface is bumpy on six scales: closed, curved both ways, no two
/// places alike, and smoother the closer one looks, as scans are. The same each time.
TriangleSoup displaced_torus(std::size_t faces);

}  // namespace lodestone::bench

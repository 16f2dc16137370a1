#pragma once

#include <cstdint>

namespace lodestone {

/// How the polygon of a sector lies around the removed vertex v; m is its corner count.
enum class SectorShape : std::uint8_t {
  Open,    ///< p0 … p(m−1) run from one constrained spoke to the next: m − 1 fine faces, m − 2 coarse ones
  Closed,  ///< p0 … p(m−1) are the whole ring: m fine faces, m − 2 coarse ones
  Moved,   ///< p(m−1) is the vertex v moves to, away from this sector; the others as in Open: m − 2 faces as before
  Lone,    ///< a face of a piece that vanishes as a whole: p0 p1, one fine face, no coarse one
};

}  // namespace lodestone

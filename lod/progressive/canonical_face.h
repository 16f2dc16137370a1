#pragma once

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// Writes a face's three wedges with the largest first, winding kept: see `ProgressiveMesh`.
inline void write_canonical(Index* face, Index a, Index b, Index c) {
  if (a >= b && a >= c) {
    face[0] = a, face[1] = b, face[2] = c;
  } else if (b >= c) {
    face[0] = b, face[1] = c, face[2] = a;
  } else {
    face[0] = c, face[1] = a, face[2] = b;
  }
}

}  // namespace lodestone::detail

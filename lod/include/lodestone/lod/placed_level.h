#pragma once

#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/vec.h>

namespace lodestone {

/// Where the vertices of a level of a progressive mesh lie so that it is closer to the full mesh.
struct PlacedLevel {
  Index position = 0;            ///< in the progressive mesh
  std::vector<Vec3f> positions;  ///< by vertex of the level
  float deviation = 0;           ///< bounds the two-sided distance between the level then and the full mesh, mesh units
  float precision = 0;           ///< mesh units: that much does not matter to the level
};

}  // namespace lodestone

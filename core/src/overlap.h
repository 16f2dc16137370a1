#pragma once

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

// Faces lie on one another at an edge where the cosine of the angle between them is larger.
inline constexpr double kLayered = 0.99;

/// Returns how two faces meet at an edge, named by a corner that it leaves in each: the cosine of the angle between
/// them, −1 where they lie flat, 1 where one lies on the other. Which way they wind does not matter.
double overlap(const Mesh& mesh, Index a, Index b);

}  // namespace lodestone::detail

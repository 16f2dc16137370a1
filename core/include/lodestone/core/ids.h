#pragma once

#include <cstdint>
#include <limits>

namespace lodestone {

/// An entry of a flat array: a vertex, wedge, corner or face number. So a mesh has at most 1.43 billion faces.
using Index = std::uint32_t;

/// "No such entry", in any array of `Index`.
inline constexpr Index kNoIndex = std::numeric_limits<Index>::max();

constexpr Index face_of_corner(Index corner) { return corner / 3; }
constexpr Index next_corner(Index corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
constexpr Index previous_corner(Index corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

}  // namespace lodestone

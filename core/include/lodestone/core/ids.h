#pragma once

#include <cstdint>
#include <limits>

namespace lodestone {

/// An entry of a flat array: a vertex, wedge, corner or face number.
using Index = std::uint32_t;

/// "No such entry", in any array of `Index`.
inline constexpr Index kNoIndex = std::numeric_limits<Index>::max();

/// A vertex: a position. Distinct from the other ids so that they cannot be mixed up at an interface.
enum class VertexId : Index {};
/// A wedge: one attribute set at a vertex.
enum class WedgeId : Index {};
/// A corner: 3·face + i, i in 0..2, counter-clockwise.
enum class CornerId : Index {};
/// A face: a triangle.
enum class FaceId : Index {};

constexpr Index index_of(VertexId id) { return static_cast<Index>(id); }
constexpr Index index_of(WedgeId id) { return static_cast<Index>(id); }
constexpr Index index_of(CornerId id) { return static_cast<Index>(id); }
constexpr Index index_of(FaceId id) { return static_cast<Index>(id); }

constexpr Index face_of_corner(Index corner) { return corner / 3; }
constexpr Index next_corner(Index corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
constexpr Index previous_corner(Index corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

}  // namespace lodestone

#pragma once

#include <cstdint>
#include <span>

namespace lodestone {

/// Polygons up to this size have a table of all their triangulations.
inline constexpr int kMaxTabulatedPolygon = 7;

/// A triangle of a polygon's corners, a < b < c, counter-clockwise.
struct PolygonTriangle {
  std::uint8_t a = 0;
  std::uint8_t b = 0;
  std::uint8_t c = 0;
  friend bool operator==(const PolygonTriangle&, const PolygonTriangle&) = default;
};

/// Returns how many triangulations a polygon has: the Catalan number C(size − 2). Pre: 2 ≤ size ≤ kMaxTabulatedPolygon.
int triangulation_count(int size);

/// Returns triangulation `which` of a polygon: size − 2 triangles. Pre: which < triangulation_count(size).
std::span<const PolygonTriangle> triangulation(int size, int which);

/// Returns triangle (a, b, c)'s number among all triangles of a polygon of at most kMaxTabulatedPolygon corners:
/// C(c,3) + C(b,2) + a, which does not depend on the polygon's size.
constexpr int triangle_number(PolygonTriangle t) { return t.c * (t.c - 1) * (t.c - 2) / 6 + t.b * (t.b - 1) / 2 + t.a; }

/// Returns the numbers of all triangulations' triangles: size − 2 of them for each, one triangulation after the other.
/// Pre: 2 ≤ size ≤ kMaxTabulatedPolygon.
std::span<const std::uint8_t> triangulation_numbers(int size);

/// Returns how many triangles a polygon's corners make: C(size, 3), more than any of their numbers.
constexpr int triangle_count(int size) { return size * (size - 1) * (size - 2) / 6; }

}  // namespace lodestone

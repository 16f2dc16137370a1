#include <lodestone/core/triangulation.h>

#include <array>
#include <cassert>
#include <vector>

// All triangulations of small convex polygons, by the recursion that counts them (Segner, 1758; the Catalan numbers):
// the triangle at one edge splits the rest in two. A heptagon, the largest that is tabulated, has 42: all can be tried.

namespace lodestone {
namespace {

using Triangles = std::vector<PolygonTriangle>;

/// Lists the triangulations of the sub-polygon first … last: the triangle at its closing edge splits it in two.
std::vector<Triangles> enumerate(int first, int last) {
  if (last - first < 2) return {{}};
  std::vector<Triangles> all;
  for (int apex = first + 1; apex < last; ++apex) {
    const PolygonTriangle t{static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(apex),
                            static_cast<std::uint8_t>(last)};
    const std::vector<Triangles> left = enumerate(first, apex);
    const std::vector<Triangles> right = enumerate(apex, last);
    for (const Triangles& l : left)
      for (const Triangles& r : right) {
        Triangles& joined = all.emplace_back(1, t);
        joined.insert(joined.end(), l.begin(), l.end());
        joined.insert(joined.end(), r.begin(), r.end());
      }
  }
  return all;
}

struct Table {
  std::array<int, kMaxTabulatedPolygon + 1> count{};
  std::array<Triangles, kMaxTabulatedPolygon + 1> triangles;
  std::array<std::vector<std::uint8_t>, kMaxTabulatedPolygon + 1> numbers;

  Table() {
    for (int size = 2; size <= kMaxTabulatedPolygon; ++size) {
      for (const Triangles& one : enumerate(0, size - 1)) {
        triangles[size].insert(triangles[size].end(), one.begin(), one.end());
        ++count[size];
      }
      for (const PolygonTriangle t : triangles[size])
        numbers[size].push_back(static_cast<std::uint8_t>(triangle_number(t)));
    }
  }
};

const Table& table() {
  static const Table kTable;
  return kTable;
}

}  // namespace

int triangulation_count(int size) {
  assert(size >= 2 && size <= kMaxTabulatedPolygon);
  return table().count[size];
}

std::span<const PolygonTriangle> triangulation(int size, int which) {
  const Triangles& all = table().triangles[size];
  const auto length = static_cast<std::size_t>(size - 2);
  return std::span(all).subspan(static_cast<std::size_t>(which) * length, length);
}

std::span<const std::uint8_t> triangulation_numbers(int size) { return table().numbers[size]; }

}  // namespace lodestone

#include <lodestone/core/triangulation.h>

#include <array>
#include <map>
#include <set>
#include <vector>

#include "support/catch.h"

namespace lodestone::test {

TEST_CASE("the table holds every triangulation once: Catalan numbers") {
  const std::array<int, 8> catalan{0, 0, 1, 1, 2, 5, 14, 42};
  for (int size = 2; size <= kMaxTabulatedPolygon; ++size) {
    CHECK(triangulation_count(size) == catalan[static_cast<std::size_t>(size)]);
    std::set<std::set<int>> distinct;
    for (int which = 0; which < triangulation_count(size); ++which) {
      std::set<int> numbers;
      for (const PolygonTriangle t : triangulation(size, which)) numbers.insert(triangle_number(t));
      CHECK(numbers.size() == static_cast<std::size_t>(size - 2));
      distinct.insert(numbers);
    }
    CHECK(distinct.size() == static_cast<std::size_t>(triangulation_count(size)));
  }
}

TEST_CASE("each triangulation covers its polygon: rim edges once, diagonals twice in opposite directions") {
  for (int size = 3; size <= kMaxTabulatedPolygon; ++size)
    for (int which = 0; which < triangulation_count(size); ++which) {
      std::map<std::pair<int, int>, int> edges;
      for (const PolygonTriangle t : triangulation(size, which)) {
        CHECK((t.a < t.b && t.b < t.c && t.c < size));
        ++edges[{t.a, t.b}], ++edges[{t.b, t.c}], ++edges[{t.c, t.a}];
      }
      for (const auto& [edge, count] : edges) {
        CHECK(count == 1);
        const bool is_rim = edge.second == (edge.first + 1) % size;
        CHECK(edges.count({edge.second, edge.first}) == (is_rim ? 0U : 1U));
      }
      CHECK(edges.size() == static_cast<std::size_t>(3 * (size - 2)));
    }
}

TEST_CASE("triangle numbers are dense and distinct") {
  constexpr int kTriangles = kMaxTabulatedPolygon * (kMaxTabulatedPolygon - 1) * (kMaxTabulatedPolygon - 2) / 6;
  std::set<int> numbers;
  for (int c = 2; c < kMaxTabulatedPolygon; ++c)
    for (int b = 1; b < c; ++b)
      for (int a = 0; a < b; ++a)
        numbers.insert(triangle_number(
            {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), static_cast<std::uint8_t>(c)}));
  CHECK(numbers.size() == static_cast<std::size_t>(kTriangles));
  CHECK(*numbers.begin() == 0);
  CHECK(*numbers.rbegin() == kTriangles - 1);
}

}  // namespace lodestone::test

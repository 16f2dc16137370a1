#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <numbers>

#include <lodestone/core/assemble.h>

namespace lodestone::test {

inline constexpr double kTurn = 2 * std::numbers::pi;

inline Index add_point(TriangleSoup& soup, double x, double y, double z) {
  soup.positions.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  return static_cast<Index>(soup.positions.size() - 1);
}

inline void add_triangle(TriangleSoup& soup, Index a, Index b, Index c) {
  soup.indices.insert(soup.indices.end(), {a, b, c});
}

/// Adds the square a b c d, counter-clockwise, cut from a to c.
inline void add_square(TriangleSoup& soup, Index a, Index b, Index c, Index d) {
  add_triangle(soup, a, b, c);
  add_triangle(soup, a, c, d);
}

/// The six sides of a box as n × n squares over points that `make_point(at, number)` makes of whole coordinates from 0
/// to n, and of the number that the point gets.
template <class MakePoint>
TriangleSoup box_of_squares(int n, MakePoint make_point) {
  TriangleSoup soup;
  std::map<std::array<int, 3>, Index> numbers;
  const auto point = [&](const std::array<int, 3>& at) {
    const auto [entry, is_new] = numbers.try_emplace(at, static_cast<Index>(soup.positions.size()));
    if (is_new) {
      const std::array<double, 3> p = make_point(at, entry->second);
      add_point(soup, p[0], p[1], p[2]);
    }
    return entry->second;
  };
  for (std::size_t side = 0; side < 6; ++side) {
    const auto corner = [&](int i, int j) {
      std::array<int, 3> at{};
      at[side / 2] = side % 2 == 0 ? n : 0;
      at[(side / 2 + 1) % 3] = side % 2 == 0 ? i : j;
      at[(side / 2 + 2) % 3] = side % 2 == 0 ? j : i;
      return point(at);
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        add_square(soup, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
  }
  return soup;
}

}  // namespace lodestone::test

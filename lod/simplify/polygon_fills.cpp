#include "simplify/polygon_fills.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lodestone::detail {

PolygonFills::Triangles PolygonFills::fan(std::size_t size, std::size_t apex) {
  fan_.clear();
  for (std::size_t i = 1; i + 1 < size; ++i) {
    std::array<std::size_t, 3> corner{apex, (apex + i) % size, (apex + i + 1) % size};
    std::sort(corner.begin(), corner.end());
    fan_.push_back(triangle(corner[0], corner[1], corner[2]));
  }
  return fan_;
}

/// Lists the triangles found, from the whole polygon's last edge inwards.
PolygonFills::Triangles PolygonFills::collect(std::size_t size) {
  cheapest_.clear();
  if (std::isinf(least_[size - 1])) return cheapest_;
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, size - 1}};
  while (!parts.empty()) {
    const auto [from, to] = parts.back();
    parts.pop_back();
    if (to - from < 2) continue;
    const std::size_t apex = apex_[from * size + to];
    cheapest_.push_back(triangle(from, apex, to));
    parts.emplace_back(from, apex);
    parts.emplace_back(apex, to);
  }
  return cheapest_;
}

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <lodestone/core/triangulation.h>

namespace lodestone::detail {

/// Larger polygons are filled with fans alone; up to here the triangulation that sweeps the least volume is found, too.
inline constexpr int kMaxSearchedPolygon = 16;

/// Triangulations of polygons too large for a table. What a function returns stands until it is called again.
class PolygonFills {
 public:
  using Triangles = std::span<const PolygonTriangle>;

  /// The one whose triangles all meet at corner `apex`.
  Triangles fan(std::size_t size, std::size_t apex);

  /// The one with the least sum of `price(triangle)` of those whose triangles are all `allowed(triangle)`, which is
  /// asked of as few as will do; empty where there is none. Dynamic programming over the polygon's parts, after
  /// G. T. Klincsek: Minimal triangulations of polygonal domains (1980).
  template <class Price, class Allowed>
  Triangles cheapest(std::size_t size, const Price& price, const Allowed& allowed) {
    least_.assign(size * size, 0);
    apex_.assign(size * size, 0);
    for (std::size_t span = 2; span < size; ++span)
      for (std::size_t from = 0; from + span < size; ++from) price_part(size, from, from + span, price, allowed);
    return collect(size);
  }

 private:
  static PolygonTriangle triangle(std::size_t a, std::size_t b, std::size_t c) {
    return {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b), static_cast<std::uint8_t>(c)};
  }

  /// Finds the cheapest triangle on the edge that cuts off corners `from` to `to`; their parts are priced already.
  template <class Price, class Allowed>
  void price_part(std::size_t size, std::size_t from, std::size_t to, const Price& price, const Allowed& allowed) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t apex = from + 1; apex < to; ++apex) {
      const double rest = least_[from * size + apex] + least_[apex * size + to];
      if (!(rest < least)) continue;
      const double sum = rest + price(triangle(from, apex, to));
      if (!(sum < least) || !allowed(triangle(from, apex, to))) continue;
      least = sum;
      apex_[from * size + to] = static_cast<std::uint8_t>(apex);
    }
    least_[from * size + to] = least;
  }

  Triangles collect(std::size_t size);

  std::vector<PolygonTriangle> fan_;
  std::vector<PolygonTriangle> cheapest_;
  std::vector<double> least_;       // by first and last corner of a part of the polygon: the sum of its prices
  std::vector<std::uint8_t> apex_;  // and the corner of the triangle on its edge
};

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/fixed_point.h"

namespace lodestone::detail {

/// Points of a grid of kMostGridBits, 16: eight bytes each, since most of the time of looking at one goes into waiting
/// for memory.
class GridPoints {
 public:
  std::size_t size() const { return points_.size(); }
  bool empty() const { return points_.empty(); }
  Vec3i operator[](std::size_t i) const { return {points_[i].x, points_[i].y, points_[i].z}; }
  Vec3i back() const { return (*this)[size() - 1]; }
  void set(std::size_t i, const Vec3i& point) { points_[i] = of(point); }
  void push_back(const Vec3i& point) { points_.push_back(of(point)); }
  void resize(std::size_t size) { points_.resize(size); }

 private:
  struct alignas(8) Point {
    std::uint16_t x = 0, y = 0, z = 0;
  };
  static Point of(const Vec3i& p) {
    return {static_cast<std::uint16_t>(p.x), static_cast<std::uint16_t>(p.y), static_cast<std::uint16_t>(p.z)};
  }

  std::vector<Point> points_;
};

}  // namespace lodestone::detail

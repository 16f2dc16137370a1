#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// Points relative to a common origin, one array for each coordinate, so that distances vectorise.
struct PointBatch {
  std::vector<float> x, y, z;

  std::size_t size() const { return x.size(); }
  void clear() {
    x.clear();
    y.clear();
    z.clear();
  }
  void add(const Vec3& p) {
    x.push_back(static_cast<float>(p.x));
    y.push_back(static_cast<float>(p.y));
    z.push_back(static_cast<float>(p.z));
  }
};

/// Writes the squared distance of each point to a triangle; `out` has points.size() entries. Single precision: the
/// points' origin should lie near.
void squared_distances(const PointBatch& points, const std::array<Vec3, 3>& triangle, float* out);

/// Returns the squared distance of a point to a segment.
double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b);

}  // namespace lodestone::detail

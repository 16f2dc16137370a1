#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// Points relative to a common origin, one array for each coordinate, so that distances vectorise.
///
/// The arrays are padded to whole vectors with whatever points were there; `size` counts the points without them.
class PointBatch {
 public:
  static constexpr std::size_t kLanes = 8;

  std::size_t size() const { return size_; }
  /// The length of the arrays: size() rounded up to whole vectors.
  std::size_t padded_size() const { return (size_ + kLanes - 1) / kLanes * kLanes; }
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }

  void clear() { size_ = 0; }
  void add(const Vec3& p) {
    if (size_ == x_.size()) grow();
    x_[size_] = static_cast<float>(p.x);
    y_[size_] = static_cast<float>(p.y);
    z_[size_] = static_cast<float>(p.z);
    ++size_;
  }

 private:
  void grow() {
    for (std::vector<float>* v : {&x_, &y_, &z_}) v->resize((2 * size_ + kLanes) / kLanes * kLanes);
  }
  std::size_t size_ = 0;
  std::vector<float> x_, y_, z_;
};

/// Writes the squared distance of each point to a triangle; `out` has points.padded_size() entries. Single precision:
/// the points' origin should lie near.
void squared_distances(const PointBatch& points, const std::array<Vec3, 3>& triangle, float* out);

/// Returns the squared distance of a point to a segment.
double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b);

}  // namespace lodestone::detail

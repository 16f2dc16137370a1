#pragma once

#include <array>

#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// An affine map in doubles: the first three rows of a 4 × 4 matrix. The identity keeps every bit of what it maps.
struct Transform {
  std::array<std::array<double, 4>, 3> rows = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  friend bool operator==(const Transform&, const Transform&) = default;
  friend Transform operator*(const Transform& a, const Transform& b);

  bool is_identity() const { return *this == Transform{}; }
  /// True if the map turns a shape into its mirror image, so that faces need the opposite winding.
  bool mirrors() const;
  /// The most that a length grows: the largest singular value of the linear part.
  double stretch() const;

  Vec3f point(const Vec3f& p) const;
  /// The same in doubles.
  Vec3 exact_point(const Vec3& p) const;
  /// Maps a direction along the surface and gives it length 1.
  Vec3f direction(const Vec3f& d) const;
  /// Maps a direction across the surface (by the inverse transpose) and gives it length 1.
  Vec3f normal(const Vec3f& n) const;
};

/// Returns translation · rotation · scale; the rotation is a quaternion x, y, z, w.
Transform from_trs(const Vec3& translation, const std::array<double, 4>& rotation, const Vec3& scale);

}  // namespace lodestone::detail

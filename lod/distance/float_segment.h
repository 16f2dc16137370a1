#pragma once

#include <algorithm>

#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// A vector in single precision, as loops over many points have it.
struct FloatVec {
  float x, y, z;
  FloatVec(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
  explicit FloatVec(const Vec3& v)
      : x(static_cast<float>(v.x)), y(static_cast<float>(v.y)), z(static_cast<float>(v.z)) {}
  float dot(float px, float py, float pz) const { return px * x + py * y + pz * z; }
};

/// Of a square of a length; 0 for 0: what is multiplied by it then says nothing.
inline float inverse_of(double square) { return square > 0 ? static_cast<float>(1 / square) : 0.0F; }

/// A segment in single precision; points come relative to its start.
struct FloatSegment {
  FloatVec direction;
  float inverse_square;

  FloatSegment(const FloatVec& d, float inverse) : direction(d), inverse_square(inverse) {}
  explicit FloatSegment(const Vec3& d) : direction(d), inverse_square(inverse_of(squared_length(d))) {}
  float squared_distance(float x, float y, float z) const {
    const float along = direction.dot(x, y, z) * inverse_square;
    const float t = std::min(std::max(along, 0.0F), 1.0F);
    const float ex = x - t * direction.x, ey = y - t * direction.y, ez = z - t * direction.z;
    return ex * ex + ey * ey + ez * ez;
  }
};

}  // namespace lodestone::detail

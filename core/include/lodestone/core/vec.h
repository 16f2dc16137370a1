#pragma once

#include <cmath>

namespace lodestone {

/// A point or direction as stored: three floats, 12 bytes, no padding.
struct Vec3f {
  float x = 0;
  float y = 0;
  float z = 0;
  friend bool operator==(const Vec3f&, const Vec3f&) = default;
};

/// A point or direction as computed with: three doubles.
struct Vec3 {
  double x = 0;
  double y = 0;
  double z = 0;

  Vec3() = default;
  Vec3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  explicit Vec3(const Vec3f& p) : x(p.x), y(p.y), z(p.z) {}

  friend bool operator==(const Vec3&, const Vec3&) = default;
  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3 operator*(double s, const Vec3& a) { return a * s; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
};

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double squared_length(const Vec3& a) { return dot(a, a); }
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// Whether a vector has a direction: its length is finite and not zero.
inline bool has_direction(const Vec3& a) {
  const double l = length(a);
  return std::isfinite(l) && l > 0;
}

/// Returns a point or direction as it is stored, rounded.
inline Vec3f to_float(const Vec3& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// Returns `a` scaled to length 1, or the zero vector where `a` has no direction.
inline Vec3 normalized(const Vec3& a) {
  const double l = length(a);
  return std::isfinite(l) && l > 0 ? a * (1.0 / l) : Vec3{};
}

/// Returns the angle between two directions in radians, accurate near 0 and π; 0 where one of them is zero.
inline double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

}  // namespace lodestone

#pragma once

#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// A symmetric 3 × 3 matrix.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

  static Symmetric3 identity(double s) { return {s, s, s, 0, 0, 0}; }
  /// s·n nᵀ
  static Symmetric3 outer(const Vec3& n, double s) {
    return {s * n.x * n.x, s * n.y * n.y, s * n.z * n.z, s * n.x * n.y, s * n.y * n.z, s * n.z * n.x};
  }
  void add(const Symmetric3& m, double s) {
    xx += s * m.xx, yy += s * m.yy, zz += s * m.zz, xy += s * m.xy, yz += s * m.yz, zx += s * m.zx;
  }
  double trace() const { return xx + yy + zz; }
  friend Symmetric3 operator+(Symmetric3 a, const Symmetric3& b) {
    a.add(b, 1);
    return a;
  }
  friend Vec3 operator*(const Symmetric3& m, const Vec3& v) {
    return {m.xx * v.x + m.xy * v.y + m.zx * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.zx * v.x + m.yz * v.y + m.zz * v.z};
  }
};

}  // namespace lodestone::detail

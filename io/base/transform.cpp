#include "base/transform.h"

#include <algorithm>
#include <cmath>

namespace lodestone::detail {
namespace {

Vec3 row(const Transform& t, int i) { return {t.rows[i][0], t.rows[i][1], t.rows[i][2]}; }

Vec3 apply_linear(const Transform& t, const Vec3& v) {
  return {dot(row(t, 0), v), dot(row(t, 1), v), dot(row(t, 2), v)};
}

}  // namespace

Transform operator*(const Transform& a, const Transform& b) {
  Transform product;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      double sum = j == 3 ? a.rows[i][3] : 0;
      for (int k = 0; k < 3; ++k) sum += a.rows[i][k] * b.rows[k][j];
      product.rows[i][j] = sum;
    }
  return product;
}

bool Transform::mirrors() const { return dot(row(*this, 0), cross(row(*this, 1), row(*this, 2))) < 0; }

double Transform::stretch() const {
  // The largest eigenvalue of AᵀA: O. K. Smith, "Eigenvalues of a symmetric 3 × 3 matrix", Comm. ACM 4(4), 1961.
  const auto gram = [&](int i, int j) {
    return rows[0][i] * rows[0][j] + rows[1][i] * rows[1][j] + rows[2][i] * rows[2][j];
  };
  const double a = gram(0, 0), b = gram(1, 1), c = gram(2, 2), d = gram(0, 1), e = gram(1, 2), f = gram(0, 2);
  const double off_diagonal = d * d + e * e + f * f;
  if (off_diagonal == 0) return std::sqrt(std::max({a, b, c}));
  const double q = (a + b + c) / 3;
  const double p = std::sqrt(((a - q) * (a - q) + (b - q) * (b - q) + (c - q) * (c - q) + 2 * off_diagonal) / 6);
  const Vec3 r0 = Vec3(a - q, d, f) * (1 / p), r1 = Vec3(d, b - q, e) * (1 / p), r2 = Vec3(f, e, c - q) * (1 / p);
  const double angle = std::acos(std::clamp(dot(r0, cross(r1, r2)) / 2, -1.0, 1.0)) / 3;
  return std::sqrt(q + 2 * p * std::cos(angle));
}

Vec3f Transform::point(const Vec3f& p) const { return is_identity() ? p : to_float(exact_point(Vec3(p))); }

Vec3 Transform::exact_point(const Vec3& p) const {
  return apply_linear(*this, p) + Vec3(rows[0][3], rows[1][3], rows[2][3]);
}

Vec3f Transform::direction(const Vec3f& d) const {
  if (is_identity()) return d;
  return to_float(normalized(apply_linear(*this, Vec3(d))));
}

Vec3f Transform::normal(const Vec3f& n) const {
  if (is_identity()) return n;
  // The cofactors are the inverse transpose times the determinant, whose sign the normal must not take over.
  const Vec3 v(n), r0 = row(*this, 0), r1 = row(*this, 1), r2 = row(*this, 2);
  const Vec3 mapped{dot(cross(r1, r2), v), dot(cross(r2, r0), v), dot(cross(r0, r1), v)};
  return to_float(normalized(mirrors() ? mapped * -1 : mapped));
}

Transform from_trs(const Vec3& translation, const std::array<double, 4>& rotation, const Vec3& scale) {
  const auto [x, y, z, w] = rotation;
  Transform t;
  t.rows[0] = {(1 - 2 * (y * y + z * z)) * scale.x, 2 * (x * y - z * w) * scale.y, 2 * (x * z + y * w) * scale.z,
               translation.x};
  t.rows[1] = {2 * (x * y + z * w) * scale.x, (1 - 2 * (x * x + z * z)) * scale.y, 2 * (y * z - x * w) * scale.z,
               translation.y};
  t.rows[2] = {2 * (x * z - y * w) * scale.x, 2 * (y * z + x * w) * scale.y, (1 - 2 * (x * x + y * y)) * scale.z,
               translation.z};
  return t;
}

}  // namespace lodestone::detail

// Means and squares are merged as by T. F. Chan, G. H. Golub, R. J. LeVeque, "Updating formulae and a pairwise
// algorithm for computing sample variances", COMPSTAT 1982, which does not cancel, however far from the origin the
// points lie.

#include "distance/point_spread.h"

#include <algorithm>
#include <cmath>

namespace lodestone::detail {
namespace {

constexpr int kSquarings = 6;  // The largest eigenvalue's share grows with the 64th power: enough for a good box.

Symmetric3 squared(const Symmetric3& m) {
  return {m.xx * m.xx + m.xy * m.xy + m.zx * m.zx, m.xy * m.xy + m.yy * m.yy + m.yz * m.yz,
          m.zx * m.zx + m.yz * m.yz + m.zz * m.zz, m.xx * m.xy + m.xy * m.yy + m.zx * m.yz,
          m.xy * m.zx + m.yy * m.yz + m.yz * m.zz, m.zx * m.xx + m.yz * m.xy + m.zz * m.zx};
}

/// The direction that a matrix of rank one maps everything to.
Vec3 image(const Symmetric3& m) {
  if (m.xx >= m.yy && m.xx >= m.zz) return normalized({m.xx, m.xy, m.zx});
  return normalized(m.yy >= m.zz ? Vec3{m.xy, m.yy, m.yz} : Vec3{m.zx, m.yz, m.zz});
}

Vec3 any_normal_to(const Vec3& a) {
  const Vec3 other = std::abs(a.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalized(cross(a, other));
}

}  // namespace

void PointSpread::add(const PointSpread& other) {
  const double both = count + other.count;
  if (!(both > 0)) return;
  const Vec3 difference = other.mean - mean;
  squares.add(other.squares, 1);
  squares.add(Symmetric3::outer(difference, 1), count * other.count / both);
  mean += difference * (other.count / both);
  count = both;
}

std::array<Vec3, 3> PointSpread::principal_axes() const {
  Symmetric3 power = squares;
  for (int i = 0; i < kSquarings && power.trace() > 0; ++i) {
    Symmetric3 unit;
    unit.add(power, 1 / power.trace());
    power = squared(unit);
  }
  const Vec3 longest = image(power);
  if (!(squared_length(longest) > 0)) return {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const Vec3 u = any_normal_to(longest);
  const Vec3 v = cross(longest, u);
  const double angle = 0.5 * std::atan2(2 * dot(u, squares * v), dot(u, squares * u) - dot(v, squares * v));
  const Vec3 middle = u * std::cos(angle) + v * std::sin(angle);
  return {longest, middle, cross(longest, middle)};
}

}  // namespace lodestone::detail

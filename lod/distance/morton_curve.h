#pragma once

#include <algorithm>
#include <cstdint>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Spreads the low 21 bits of `x` to every third bit.
inline std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

/// Orders points along a curve through a box, such that those that follow each other mostly lie together: G. M. Morton,
/// A computer oriented geodetic data base and a new technique in file sequencing (IBM, 1966).
class MortonCurve {
 public:
  explicit MortonCurve(const Box& box) : low_(box.low) {
    const Vec3 extent = box.high - box.low;
    const double largest = std::max({extent.x, extent.y, extent.z});
    scale_ = largest > 0 ? 2097151.0 / largest : 0;
  }
  /// Returns how far along the curve a point is, in 63 bits; points outside the box are taken for those of its surface.
  std::uint64_t code(const Vec3& p) const {
    const auto cell = [&](double v) { return static_cast<std::uint64_t>(std::clamp(v * scale_, 0.0, 2097151.0)); };
    const Vec3 d = p - low_;
    return spread_bits(cell(d.x)) | spread_bits(cell(d.y)) << 1 | spread_bits(cell(d.z)) << 2;
  }

 private:
  Vec3 low_;
  double scale_;
};

}  // namespace lodestone::detail

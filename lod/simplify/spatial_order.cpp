// Morton: A computer oriented geodetic data base and a new technique in file sequencing (IBM, 1966).

#include "simplify/spatial_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace lodestone::detail {
namespace {

/// Spreads the low 21 bits of `x` to every third bit.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

class MortonCurve {
 public:
  explicit MortonCurve(const Box& box) : low_(box.low) {
    const Vec3 extent = box.high - box.low;
    const double largest = std::max({extent.x, extent.y, extent.z});
    scale_ = largest > 0 ? 2097151.0 / largest : 0;
  }
  std::uint64_t code(const Vec3& p) const {
    const auto cell = [&](double v) { return static_cast<std::uint64_t>(std::clamp(v * scale_, 0.0, 2097151.0)); };
    const Vec3 d = p - low_;
    return spread_bits(cell(d.x)) | spread_bits(cell(d.y)) << 1 | spread_bits(cell(d.z)) << 2;
  }

 private:
  Vec3 low_;
  double scale_;
};

using Coded = std::pair<std::uint64_t, Index>;  // ties go to the lower number

/// The faces along the curve, by centroid.
std::vector<Index> face_order(const Mesh& mesh) {
  const MortonCurve curve(bounding_box(mesh));
  std::vector<Coded> coded(mesh.face_count());
  for (Index f = 0; f < coded.size(); ++f) {
    const Vec3 sum = mesh.corner_position(3 * f) + mesh.corner_position(3 * f + 1) + mesh.corner_position(3 * f + 2);
    coded[f] = {curve.code(sum * (1.0 / 3)), f};
  }
  std::sort(coded.begin(), coded.end());
  std::vector<Index> order;
  order.reserve(coded.size());
  for (const Coded& c : coded) order.push_back(c.second);
  return order;
}

}  // namespace

Mesh in_spatial_order(const Mesh& mesh, std::vector<Index>& source_vertex) {
  return pick_faces(mesh, face_order(mesh), &source_vertex);
}

}  // namespace lodestone::detail

#include "distance/point_triangle.h"

#include <algorithm>

// Distances from many points to one triangle without branches: over its inside the distance is that to its plane,
// elsewhere to its nearest edge. Case analyses such as C. Ericson's ("Real-Time Collision Detection", 2005,
// section 5.1.5) find the same with less arithmetic for one point, but do not vectorise.

namespace lodestone::detail {
namespace {

struct FloatVec {
  float x, y, z;
  explicit FloatVec(const Vec3& v)
      : x(static_cast<float>(v.x)), y(static_cast<float>(v.y)), z(static_cast<float>(v.z)) {}
};

/// Everything about one edge that does not depend on the point: its start, direction and the normal pointing inwards.
struct EdgeFrame {
  FloatVec start, direction, inward;
  float inverse_square;

  EdgeFrame(const Vec3& a, const Vec3& b, const Vec3& normal)
      : start(a), direction(b - a), inward(cross(normal, b - a)) {
    const double square = squared_length(b - a);
    inverse_square = square > 0 ? static_cast<float>(1 / square) : 0.0F;
  }
  float side(float x, float y, float z) const {
    return (x - start.x) * inward.x + (y - start.y) * inward.y + (z - start.z) * inward.z;
  }
  float squared_distance(float x, float y, float z) const {
    const float dx = x - start.x, dy = y - start.y, dz = z - start.z;
    const float along = (dx * direction.x + dy * direction.y + dz * direction.z) * inverse_square;
    const float t = std::min(std::max(along, 0.0F), 1.0F);
    const float ex = dx - t * direction.x, ey = dy - t * direction.y, ez = dz - t * direction.z;
    return ex * ex + ey * ey + ez * ez;
  }
};

}  // namespace

// The same instructions on wider vectors give the same numbers: there is no fused multiply-add (see LodestoneTarget).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
__attribute__((target_clones("avx2", "default")))
#endif
void squared_distances(const PointBatch& points, const std::array<Vec3, 3>& triangle, float* out) {
  const Vec3 normal = normalized(cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
  const FloatVec n(normal);
  const EdgeFrame e0(triangle[0], triangle[1], normal);
  const EdgeFrame e1(triangle[1], triangle[2], normal);
  const EdgeFrame e2(triangle[2], triangle[0], normal);
  const float* px = points.x();
  const float* py = points.y();
  const float* pz = points.z();
  const std::size_t count = points.padded_size() / PointBatch::kLanes * PointBatch::kLanes;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = px[i], y = py[i], z = pz[i];
    const float height = (x - e0.start.x) * n.x + (y - e0.start.y) * n.y + (z - e0.start.z) * n.z;
    const float side = std::min(std::min(e0.side(x, y, z), e1.side(x, y, z)), e2.side(x, y, z));
    const float edge =
        std::min(std::min(e0.squared_distance(x, y, z), e1.squared_distance(x, y, z)), e2.squared_distance(x, y, z));
    const float plane = height * height;
    out[i] = side > 0 ? plane : edge;
  }
}

double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double square = squared_length(d);
  const double t = square > 0 ? std::clamp(dot(p - a, d) / square, 0.0, 1.0) : 0.0;
  return squared_length(p - (a + d * t));
}

}  // namespace lodestone::detail

#include "distance/point_triangle.h"

#include <algorithm>

#include "distance/float_segment.h"
#include "distance/wide_vectors.h"

// Distances from many points to one triangle without branches: over its inside the distance is that to its plane,
// elsewhere to its nearest edge. Case analyses such as C. Ericson's ("Real-Time Collision Detection", 2005,
// section 5.1.5) find the same with less arithmetic for one point, but do not vectorise.

namespace lodestone::detail {
namespace {

/// Everything about one edge that does not depend on the point: its start, itself and the normal pointing inwards.
struct EdgeFrame {
  FloatVec start, inward;
  FloatSegment edge;

  EdgeFrame(const Vec3& a, const Vec3& b, const Vec3& normal) : start(a), inward(cross(normal, b - a)), edge(b - a) {}
  float side(float x, float y, float z) const { return inward.dot(x - start.x, y - start.y, z - start.z); }
  float squared_distance(float x, float y, float z) const {
    return edge.squared_distance(x - start.x, y - start.y, z - start.z);
  }
};

}  // namespace

LODESTONE_WIDE_VECTORS
void squared_distances(const PointBatch& points, const std::array<Vec3, 3>& triangle, float* out) {
  const Vec3 normal = normalized(cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
  const FloatVec n(normal);
  const EdgeFrame e0(triangle[0], triangle[1], normal);
  const EdgeFrame e1(triangle[1], triangle[2], normal);
  const EdgeFrame e2(triangle[2], triangle[0], normal);
  const float* px = points.x();
  const float* py = points.y();
  const float* pz = points.z();
  const std::size_t count = points.padded_size();
  for (std::size_t i = 0; i < count; ++i) {
    const float x = px[i], y = py[i], z = pz[i];
    const float height = n.dot(x - e0.start.x, y - e0.start.y, z - e0.start.z);
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

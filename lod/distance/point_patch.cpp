// As in point_triangle.cpp: a triangle's distance is that to its plane over its inside, elsewhere to its nearest edge;
// so that to several is the least of all edges' distances and of those planes' whose inside the point is over.

#include "distance/point_patch.h"

#include <algorithm>
#include <limits>

#include "distance/float_segment.h"
#include "distance/wide_vectors.h"

namespace lodestone::detail {
namespace {

/// A triangle relative to its first corner, with two of its edges; s and t lead to its other corners.
struct Face {
  FloatVec normal, inside_first, inside_second, inside_third, second_start;
  float inverse_normal;
  float second_level;
  FloatSegment first, second;

  Face(const Vec3& s, const Vec3& t) : Face(s, t, cross(s, t), cross(cross(s, t), t - s)) {}

 private:
  Face(const Vec3& s, const Vec3& t, const Vec3& n, const Vec3& across)
      : normal(n),
        inside_first(cross(n, s)),
        inside_second(across),
        inside_third(cross(t, n)),
        second_start(s),
        inverse_normal(inverse_of(squared_length(n))),
        second_level(static_cast<float>(dot(across, s))),
        first(s),
        second(t - s) {}
};

}  // namespace

LODESTONE_WIDE_VECTORS
void squared_distances(const PointBatch& points, const Patch& patch, float* out) {
  const float* px = points.x();
  const float* py = points.y();
  const float* pz = points.z();
  const std::size_t count = points.padded_size() / PointBatch::kLanes * PointBatch::kLanes;
  for (std::size_t i = 0; i < count; ++i) out[i] = std::numeric_limits<float>::infinity();
  for (const PolygonTriangle t : patch.triangles) {
    const Vec3& corner = patch.corners[t.a];
    const FloatVec a(corner);
    const Face face(patch.corners[t.b] - corner, patch.corners[t.c] - corner);
    for (std::size_t i = 0; i < count; ++i) {
      const float x = px[i] - a.x, y = py[i] - a.y, z = pz[i] - a.z;
      const float height = face.normal.dot(x, y, z);
      const float side = std::min(std::min(face.inside_first.dot(x, y, z), face.inside_third.dot(x, y, z)),
                                  face.inside_second.dot(x, y, z) - face.second_level);
      const float edge = std::min(
          face.first.squared_distance(x, y, z),
          face.second.squared_distance(x - face.second_start.x, y - face.second_start.y, z - face.second_start.z));
      const float plane = height * height * face.inverse_normal;
      const float nearest = side > 0 ? plane : edge;
      out[i] = std::min(out[i], nearest);
    }
    if (t.a != 0 || t.c + std::size_t{1} != patch.corners.size()) continue;
    const FloatSegment third(patch.corners[t.c] - corner);
    for (std::size_t i = 0; i < count; ++i)
      out[i] = std::min(out[i], third.squared_distance(px[i] - a.x, py[i] - a.y, pz[i] - a.z));
  }
}

}  // namespace lodestone::detail

// As in point_triangle.cpp: a triangle's distance is that to its plane over its inside, elsewhere to its nearest edge;
// so that to several is the least of all edges' distances and of those planes' whose inside the point is over.

#include "simplify/face_frames.h"

#include <algorithm>
#include <limits>

#include "distance/float_segment.h"
#include "distance/wide_vectors.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kLanes = 4;

/// Vectors in double precision, an array for each coordinate.
struct WideVectors {
  std::array<double, FaceFrames::kMost> x, y, z;
  void set(std::size_t i, const Vec3& v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
  Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

}  // namespace

/// One triangle's numbers.
struct FaceFrames::Frame {
  FloatVec start, normal;
  FloatSegment first, second;
  FloatVec inside_first, inside_second, inside_third;
  float inverse_normal, second_level;

  float squared_distance(float px, float py, float pz) const {
    const float x = px - start.x, y = py - start.y, z = pz - start.z;
    const float height = normal.dot(x, y, z);
    const float side = std::min(std::min(inside_first.dot(x, y, z), inside_third.dot(x, y, z)),
                                inside_second.dot(x, y, z) - second_level);
    const FloatVec& a = first.direction;
    const float edge = std::min(first.squared_distance(x, y, z), second.squared_distance(x - a.x, y - a.y, z - a.z));
    return side > 0 ? height * height * inverse_normal : edge;
  }
};

inline FaceFrames::Frame FaceFrames::frame(std::size_t i) const {
  const auto vector = [i](const Vectors& v) { return FloatVec(v.x[i], v.y[i], v.z[i]); };
  return {vector(start_),
          vector(normal_),
          {vector(first_), inverse_first_[i]},
          {vector(second_), inverse_second_[i]},
          vector(inside_first_),
          vector(inside_second_),
          vector(inside_third_),
          inverse_normal_[i],
          second_level_[i]};
}

LODESTONE_WIDE_VECTORS
void FaceFrames::set(std::span<const Vec3> corners, std::span<const PolygonTriangle> triangles) {
  WideVectors a, b, c;
  count_ = triangles.size();
  const std::size_t padded = (count_ + kLanes - 1) / kLanes * kLanes;
  for (std::size_t i = 0; i < padded; ++i) {
    const PolygonTriangle t = triangles[std::min(i, count_ - 1)];
    a.set(i, corners[t.a]), b.set(i, corners[t.b]), c.set(i, corners[t.c]);
  }
  const auto write = [](Vectors& to, std::size_t i, const Vec3& v) {
    to.x[i] = static_cast<float>(v.x), to.y[i] = static_cast<float>(v.y), to.z[i] = static_cast<float>(v.z);
  };
  for (std::size_t i = 0; i < padded; ++i) {
    const Vec3 s = b[i] - a[i], t = c[i] - a[i];
    const Vec3 n = cross(s, t), across = cross(n, t - s);
    write(start_, i, a[i]), write(normal_, i, n);
    write(first_, i, s), write(second_, i, t - s);
    write(inside_first_, i, cross(n, s)), write(inside_second_, i, across), write(inside_third_, i, cross(t, n));
    inverse_normal_[i] = inverse_of(squared_length(n));
    inverse_first_[i] = inverse_of(squared_length(s));
    inverse_second_[i] = inverse_of(squared_length(t - s));
    second_level_[i] = static_cast<float>(dot(across, s));
  }
}

LODESTONE_WIDE_VECTORS
void FaceFrames::squared_distances(const PointBatch& points, float* __restrict out) const {
  const float* px = points.x();
  const float* py = points.y();
  const float* pz = points.z();
  const std::size_t count = points.padded_size();
  for (std::size_t triangle = 0; triangle < count_; ++triangle, out += count) {
    const Frame face = frame(triangle);
    for (std::size_t i = 0; i < count; ++i) out[i] = face.squared_distance(px[i], py[i], pz[i]);
  }
}

LODESTONE_WIDE_VECTORS
void FaceFrames::least_squared_distances(const PointBatch& points, float* __restrict out) const {
  const float* px = points.x();
  const float* py = points.y();
  const float* pz = points.z();
  const std::size_t count = points.padded_size();
  for (std::size_t i = 0; i < count; ++i) out[i] = std::numeric_limits<float>::infinity();
  for (std::size_t triangle = 0; triangle < count_; ++triangle) {
    const Frame face = frame(triangle);
    for (std::size_t i = 0; i < count; ++i) out[i] = std::min(out[i], face.squared_distance(px[i], py[i], pz[i]));
  }
}

LODESTONE_WIDE_VECTORS
void squared_distances(const PointBatch& points, const Vec3& from, const Vec3& to, float* __restrict out) {
  const FloatVec start(from);
  const FloatSegment segment(to - from);
  const float* px = points.x();
  const float* py = points.y();
  const float* pz = points.z();
  const std::size_t count = points.padded_size();
  for (std::size_t i = 0; i < count; ++i)
    out[i] = segment.squared_distance(px[i] - start.x, py[i] - start.y, pz[i] - start.z);
}

}  // namespace lodestone::detail

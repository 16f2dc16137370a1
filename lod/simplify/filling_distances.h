#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/triangulation.h>

#include "distance/point_triangle.h"
#include "simplify/face_frames.h"
#include "simplify/polygon_fills.h"
#include "simplify/removal_cost.h"

namespace lodestone::detail {

/// Distances of points to several ways of filling a hole. What these share is measured once.
class FillingDistances {
 public:
  /// Forgets all fillings.
  void clear();
  /// Adds a filling, of at most kMostMeasured.
  void add(std::span<const PolygonTriangle> triangles);
  /// Measures what was added; the ring is relative to the points' origin.
  void measure(const PointBatch& points, std::span<const Vec3> ring);
  /// Returns the squared distance of each point to the nearest triangle of a filling, by the order in which they were
  /// added; padded as the points are. They stand until the next call.
  const float* to(std::size_t filling);

 private:
  /// Where a triangle's distances lie, unless it was added for another ring.
  struct Row {
    std::uint32_t ring = 0;
    std::uint32_t row = 0;
  };
  static constexpr std::size_t kMostTriangles = kMaxSearchedPolygon - 2;
  struct Filling {
    std::size_t size = 0;
    std::array<std::uint8_t, kMostTriangles> rows{};  // of its triangles
  };

  std::uint32_t ring_ = 0;
  std::array<Row, triangle_count(kMaxSearchedPolygon)> row_;  // by triangle number
  std::array<PolygonTriangle, kMostMeasured * kMostTriangles> triangles_;
  std::size_t triangle_count_ = 0;
  std::array<Filling, kMostMeasured> fillings_;
  std::size_t filling_count_ = 0;
  std::size_t padded_ = 0;        // entries of a row
  std::vector<float> distances_;  // row by row: to the edge that closes the ring, and to each triangle
  std::vector<float> least_;
  FaceFrames frames_;
};

}  // namespace lodestone::detail

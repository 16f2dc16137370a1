#include "simplify/filling_distances.h"

#include <algorithm>
#include <limits>

#include "distance/wide_vectors.h"

namespace lodestone::detail {
namespace {

LODESTONE_WIDE_VECTORS
void take_less(const float* __restrict other, std::size_t count, float* __restrict least) {
  for (std::size_t i = 0; i < count / PointBatch::kLanes * PointBatch::kLanes; ++i)
    least[i] = std::min(least[i], other[i]);
}

}  // namespace

void FillingDistances::clear() {
  ++ring_;
  triangle_count_ = 0;
  filling_count_ = 0;
}

void FillingDistances::add(std::span<const PolygonTriangle> triangles) {
  Filling& filling = fillings_[filling_count_++];
  filling.size = triangles.size();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    Row& row = row_[static_cast<std::size_t>(triangle_number(triangles[i]))];
    if (row.ring != ring_) {
      triangles_[triangle_count_++] = triangles[i];
      row = {ring_, static_cast<std::uint32_t>(triangle_count_)};
    }
    filling.rows[i] = static_cast<std::uint8_t>(row.row);
  }
}

void FillingDistances::measure(const PointBatch& points, std::span<const Vec3> ring) {
  padded_ = points.padded_size();
  const std::size_t needed = (1 + triangle_count_) * padded_;
  if (distances_.size() < needed) distances_.resize(2 * needed);
  squared_distances(points, ring.front(), ring.back(), distances_.data());
  for (std::size_t i = 0; i < triangle_count_; i += FaceFrames::kMost) {
    frames_.set(ring, {triangles_.data() + i, std::min(FaceFrames::kMost, triangle_count_ - i)});
    frames_.squared_distances(points, distances_.data() + (1 + i) * padded_);
  }
}

const float* FillingDistances::to(std::size_t number) {
  const Filling& filling = fillings_[number];
  least_.assign(padded_, std::numeric_limits<float>::infinity());  // nor is what is not a number less than that
  take_less(distances_.data(), padded_, least_.data());
  for (std::size_t i = 0; i < filling.size; ++i)
    take_less(distances_.data() + filling.rows[i] * padded_, padded_, least_.data());
  return least_.data();
}

}  // namespace lodestone::detail

#include "codec/ring.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace lodestone::detail {
namespace {

constexpr std::int64_t kLeastRadius = 16;  // a step of the grid

}  // namespace

Vec3i unit(Vec3i v) {
  shorten(v, 24);
  const std::int64_t length = square_root(squared(v));
  if (length == 0) return {};
  return scaled(v, (std::int64_t{1} << (kUnitBits + kScaleBits)) / length);
}

void Ring::look(const PatchMesh& mesh, std::span<const Index> outer, bool closed, const GridPoints& positions,
                std::span<const Vec3i> normals) {
  corners_.clear();
  beyond_.clear();
  points_.clear();
  for (const Index half : outer) {
    corners_.push_back(mesh.from(half));
    const Index twin = mesh.twin(half);
    if (twin != kNoIndex) beyond_.push_back(mesh.apex(twin));
  }
  if (!closed) corners_.push_back(mesh.to(outer.back()));
  for (const Index corner : corners_) points_.push_back(positions[corner] * 16);
  find_mean(outer, closed);
  find_pulls(mesh, outer, positions, normals);
  find_spread();
}

void Ring::find_mean(std::span<const Index> outer, bool closed) {
  Vec3i sum, area;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const Vec3i& p = points_[i];
    const Vec3i& q = points_[i + 1 < points_.size() ? i + 1 : 0];
    sum = sum + p;
    const Vec3i turn = cross(p - points_[0], q - points_[0]);
    area = area + Vec3i{turn.x >> 8, turn.y >> 8, turn.z >> 8};
  }
  normal = unit(area);
  mean = closed ? divide(sum, static_cast<std::int64_t>(outer.size())) : divide(points_.front() + points_.back(), 2);
  std::uint64_t squares = 0, least = ~std::uint64_t{0};
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const std::uint64_t square = squared(points_[i] - mean);
    squares += square;
    least = std::min(least, square);
  }
  radius = std::max<std::int64_t>(kLeastRadius, square_root(squares / outer.size()));
  over_radius = (std::int64_t{1} << (kRadiusBits + kScaleBits)) / radius;
  log_least = log2_16(least) / 2;
}

void Ring::find_pulls(const PatchMesh& mesh, std::span<const Index> outer, const GridPoints& positions,
                      std::span<const Vec3i> normals) {
  Vec3i beyond, edges, parallelograms, planes;
  std::int64_t edge_weight = 0, parallelogram_weight = 0, distance = 0;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const Vec3i& p = points_[i];
    const Vec3i& q = points_[i + 1 < points_.size() ? i + 1 : 0];
    const std::int64_t length = square_root(squared(p - q)) + 1;
    edges = edges + (p + q) * length;
    edge_weight += 2 * length;
    const Index twin = mesh.twin(outer[i]);
    if (twin == kNoIndex) continue;
    const Vec3i o = positions[mesh.apex(twin)] * 16;
    beyond = beyond + o;
    distance += square_root(squared(o - mean));
    // The square of twice the height, in quarter steps: what lies close says more.
    const auto height = static_cast<std::int64_t>(squared(p + q - o * 2) >> 4U);
    const std::int64_t weight = 1 + (std::int64_t{1} << 24) / (height / 64 + 256);
    parallelograms = parallelograms + (p + q - o) * weight;
    parallelogram_weight += weight;
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3i& n = normals[corners_[i]];
    planes = planes + times(n, along(points_[i] - mean, n));
  }
  const auto count = static_cast<std::int64_t>(beyond_.size());
  pulls[0] = count == 0 ? Vec3i{} : divide(beyond, count) - mean;
  pulls[1] = divide(edges, edge_weight) - mean;
  pulls[2] = count == 0 ? Vec3i{} : divide(parallelograms, parallelogram_weight) - mean;
  pulls[3] = divide(planes, size());
  log_edge = log2_16(static_cast<std::uint64_t>(edge_weight) / (2 * outer.size()));
  log_beyond = count == 0 ? 0 : log2_16(static_cast<std::uint64_t>(distance / count + 1));
}

void Ring::find_spread() {
  std::int64_t sums[3][3] = {};
  for (const Vec3i& p : points_) {
    const Vec3i d = p - mean;
    const Vec3i across = d - times(normal, along(d, normal));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) sums[i][j] += across[i] * across[j] >> 4;
  }
  std::int64_t trace = (sums[0][0] + sums[1][1] + sums[2][2]) / 2 + 1;
  const int shift = std::max(0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(trace))) - 36);
  // No entry is more than twice the trace.
  trace = std::max<std::int64_t>(trace >> shift, 1);
  const int bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(trace)));
  const std::int64_t over_trace = (std::int64_t{1} << (bits + kRatioBits)) / trace;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) spread[i][j] = spread[j][i] = (sums[i][j] >> shift) * over_trace >> bits;
}

}  // namespace lodestone::detail

#include "distance/face_boxes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "distance/morton_curve.h"
#include "distance/tree_levels.h"
#include "distance/triangle.h"
#include "distance/wide_vectors.h"

namespace lodestone::detail {
namespace {

// How large a run's box may be, in boxes of a face. Eight faces that lie together make one of about three; faces in any
// order make one as large as the mesh.
constexpr double kTogetherSize = 8;

constexpr std::size_t kRunsOfSample = 7;  // Of so many one is looked at for that.

constexpr float kNothing = std::numeric_limits<float>::infinity();

Vec3f least(const Vec3f& a, const Vec3f& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3f most(const Vec3f& a, const Vec3f& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

double squared_distance_to_box(const Vec3& p, const Triangle& triangle) {
  const auto beyond = [](double x, float a, float b, float c) {
    const auto low = static_cast<double>(std::min({a, b, c})), high = static_cast<double>(std::max({a, b, c}));
    return std::max({low - x, x - high, 0.0});
  };
  return squared_length({beyond(p.x, triangle.a.x, triangle.b.x, triangle.c.x),
                         beyond(p.y, triangle.a.y, triangle.b.y, triangle.c.y),
                         beyond(p.z, triangle.a.z, triangle.b.z, triangle.c.z)});
}

}  // namespace

FaceBoxes::Node::Node() {
  for (std::array<float, kWidth>& axis : low) axis.fill(kNothing);
  for (std::array<float, kWidth>& axis : high) axis.fill(-kNothing);
}

void FaceBoxes::Node::add(std::size_t child, const Vec3f& low_end, const Vec3f& high_end) {
  const float ends[2][3] = {{low_end.x, low_end.y, low_end.z}, {high_end.x, high_end.y, high_end.z}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis][child] = std::min(low[axis][child], ends[0][axis]);
    high[axis][child] = std::max(high[axis][child], ends[1][axis]);
  }
}

FaceBoxes::FaceBoxes(const Mesh& mesh) : mesh_(mesh) {
  if (mesh.face_count() == 0) return;
  TreeLevels levels = tree_levels((mesh.face_count() + kWidth - 1) / kWidth, kWidth);
  level_begin_ = std::move(levels.begin);
  nodes_.resize(levels.node_count);
  fit_runs();
  if (!is_together()) {
    sort_along_curve();
    std::fill(nodes_.begin(), nodes_.end(), Node());
    fit_runs();
  }
  fit_levels();
}

void FaceBoxes::fit_runs() {
  constexpr std::size_t kFaces = kWidth * kWidth;
  for (std::size_t i = 0; i < mesh_.face_count(); ++i) {
    const auto [a, b, c] = triangle_of(mesh_, face_at(i));
    nodes_[i / kFaces].add(i / kWidth % kWidth, least(least(a, b), c), most(most(a, b), c));
  }
}

/// Whether the faces of most runs lie together, by some runs.
bool FaceBoxes::is_together() const {
  double faces = 0, runs = 0;
  for (std::size_t run = 0; run < mesh_.face_count() / kWidth; run += kRunsOfSample) {
    for (std::size_t i = kWidth * run; i < kWidth * (run + 1); ++i) {
      const auto [a, b, c] = triangle_of(mesh_, static_cast<Index>(i));
      faces += length(Vec3(most(most(a, b), c)) - Vec3(least(least(a, b), c)));
    }
    const Node& node = nodes_[run / kWidth];
    const auto size = [&](std::size_t axis) {
      return static_cast<double>(node.high[axis][run % kWidth]) - static_cast<double>(node.low[axis][run % kWidth]);
    };
    runs += length(Vec3{size(0), size(1), size(2)});
  }
  return runs * kWidth <= kTogetherSize * faces;
}

void FaceBoxes::sort_along_curve() {
  const MortonCurve curve(bounding_box(mesh_));
  std::vector<std::uint64_t> keys(mesh_.face_count());
  for (Index f = 0; f < keys.size(); ++f) {
    const auto [a, b, c] = triangle_of(mesh_, f);
    keys[f] = curve.code((Vec3(a) + Vec3(b) + Vec3(c)) * (1.0 / 3)) >> 31 << 32 | f;
  }
  std::sort(keys.begin(), keys.end());
  order_.assign(keys.begin(), keys.end());
}

void FaceBoxes::fit_levels() {
  for (std::size_t level = 1; level < level_begin_.size(); ++level) {
    const std::size_t below = level_begin_[level - 1], begin = level_begin_[level];
    for (std::size_t i = 0; below + i < begin; ++i) {
      const Node& child = nodes_[below + i];
      const auto of_all = [&](std::size_t axis) {
        return std::pair{*std::min_element(child.low[axis].begin(), child.low[axis].end()),
                         *std::max_element(child.high[axis].begin(), child.high[axis].end())};
      };
      const auto [x, y, z] = std::array{of_all(0), of_all(1), of_all(2)};
      nodes_[begin + i / kWidth].add(i % kWidth, {x.first, y.first, z.first}, {x.second, y.second, z.second});
    }
  }
}

NearFace FaceBoxes::nearest(const Vec3& p, Index hint) const {
  Best best;
  if (hint != kNoIndex) look_at(p, hint, best);
  if (!nodes_.empty()) open(level_begin_.size() - 1, 0, p, best);
  return {best.face, std::sqrt(best.squared)};
}

void FaceBoxes::look_at(const Vec3& p, Index face, Best& best) const {
  const Triangle triangle = triangle_of(mesh_, face);
  if (!(squared_distance_to_box(p, triangle) < best.squared)) return;
  const double squared = squared_length(p - nearest_on_triangle(p, triangle));
  if (squared < best.squared) best = {face, squared};
}

/// Looks at what may be nearer than the best so far, the children nearest first.
void FaceBoxes::open(std::size_t level, std::size_t number, const Vec3& p, Best& best) const {
  Distances distances = squared_distances(nodes_[level_begin_[level] + number], p);
  for (;;) {
    const auto nearest = std::min_element(distances.begin(), distances.end());
    if (!(*nearest < best.squared)) return;
    *nearest = std::numeric_limits<double>::infinity();
    const std::size_t child = kWidth * number + static_cast<std::size_t>(nearest - distances.begin());
    if (level > 0) {
      open(level - 1, child, p, best);
      continue;
    }
    const std::size_t end = std::min(kWidth * (child + 1), mesh_.face_count());
    for (std::size_t i = kWidth * child; i < end; ++i) look_at(p, face_at(i), best);
  }
}

LODESTONE_WIDE_VECTORS FaceBoxes::Distances FaceBoxes::squared_distances(const Node& node, const Vec3& p) {
  const double at[3] = {p.x, p.y, p.z};
  Distances sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < kWidth; ++i) {
      const double below = static_cast<double>(node.low[axis][i]) - at[axis];
      const double above = at[axis] - static_cast<double>(node.high[axis][i]);
      const double beyond = std::max(std::max(below, above), 0.0);
      sum[i] += beyond * beyond;
    }
  }
  return sum;
}

}  // namespace lodestone::detail

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Boxes around runs of a mesh's faces, for a few thousand searches: they take a twentieth of the memory of a
/// SurfaceIndex and of the time to make it. A search takes several times as long.
class FaceBoxes {
 public:
  /// The mesh outlives the object. Faces that follow each other should lie together, as the simplifier's do; where they
  /// do not they are sorted along a curve. Cost: O(n), or O(n log n).
  explicit FaceBoxes(const Mesh& mesh);

  /// Calls `visit(face)` for the faces of those runs whose boxes are nearer to `p` than a distance, the nearest run
  /// first: `squared` is that distance's square, and what each call returns in its place.
  template <class Visit>
  void visit_nearer(const Vec3& p, double squared, const Visit& visit) const {
    if (!nodes_.empty()) open(level_begin_.size() - 1, 0, p, squared, visit);
  }

 private:
  static constexpr std::size_t kWidth = 8;  // Children of a node, and faces of a run.

  /// The boxes of a node's children: they contain nothing by default.
  struct Node {
    std::array<std::array<float, kWidth>, 3> low, high;

    Node();
    void add(std::size_t child, const Vec3f& low_end, const Vec3f& high_end);
  };
  using Distances = std::array<double, kWidth>;

  static Distances squared_distances(const Node& node, const Vec3& p);
  void add_runs();
  void add_levels();
  bool is_together() const;
  void sort_along_curve();
  Index face_at(std::size_t place) const { return order_.empty() ? static_cast<Index>(place) : order_[place]; }

  template <class Visit>
  void open(std::size_t level, std::size_t number, const Vec3& p, double& squared, const Visit& visit) const {
    Distances distances = squared_distances(nodes_[level_begin_[level] + number], p);
    for (;;) {
      const auto nearest = std::min_element(distances.begin(), distances.end());
      if (!(*nearest < squared)) return;
      *nearest = std::numeric_limits<double>::infinity();
      const std::size_t child = kWidth * number + static_cast<std::size_t>(nearest - distances.begin());
      if (level > 0) {
        open(level - 1, child, p, squared, visit);
        continue;
      }
      for (std::size_t i = kWidth * child; i < std::min(kWidth * (child + 1), mesh_.face_count()); ++i)
        squared = visit(face_at(i));
    }
  }

  const Mesh& mesh_;
  std::vector<Index> order_;              // The faces; empty where they stay as the mesh has them.
  std::vector<Node> nodes_;               // Level by level from the runs up: child i of node n is 8·n + i.
  std::vector<std::size_t> level_begin_;  // The first node of each level.
};

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// A face, and how far it is.
struct NearFace {
  Index face = kNoIndex;
  double distance = std::numeric_limits<double>::infinity();
};

/// Boxes around runs of a mesh's faces, for a few thousand searches: they take a twentieth of the memory of a
/// SurfaceIndex and of the time to make it. A search takes several times as long.
class FaceBoxes {
 public:
  /// The mesh outlives the object. Faces that follow each other should lie together, as the simplifier's do; where they
  /// do not they are sorted along a curve. Cost: O(n), or O(n log n).
  explicit FaceBoxes(const Mesh& mesh);

  /// Returns the nearest face to `p`; `hint` is one likely near it, or kNoIndex.
  NearFace nearest(const Vec3& p, Index hint) const;

 private:
  static constexpr std::size_t kWidth = 8;  // Children of a node, and faces of a run.

  /// The boxes of a node's children: they contain nothing by default.
  struct Node {
    std::array<std::array<float, kWidth>, 3> low, high;

    Node();
    void add(std::size_t child, const Vec3f& low_end, const Vec3f& high_end);
  };
  using Distances = std::array<double, kWidth>;

  /// The nearest face so far.
  struct Best {
    Index face = kNoIndex;
    double squared = std::numeric_limits<double>::infinity();
  };

  static Distances squared_distances(const Node& node, const Vec3& p);
  void fit_runs();
  void fit_levels();
  bool is_together() const;
  void sort_along_curve();
  Index face_at(std::size_t place) const { return order_.empty() ? static_cast<Index>(place) : order_[place]; }

  void look_at(const Vec3& p, Index face, Best& best) const;
  void open(std::size_t level, std::size_t number, const Vec3& p, Best& best) const;

  const Mesh& mesh_;
  std::vector<Index> order_;              // The faces; empty where they stay as the mesh has them.
  std::vector<std::size_t> level_begin_;  // The first node of each level.
  std::vector<Node> nodes_;               // Level by level from the runs up: child i of node n is 8·n + i.
};

}  // namespace lodestone::detail

#pragma once

#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// The memory of the removed surface: points of the full mesh, each carried by the face that now stands for it.
///
/// Points are the original faces' centroids, from the start, and every vertex from its removal on. A list is kept for
/// each face slot; points 0 … vertex_count − 1 are vertices, the rest centroids. A point's weight says how many it
/// stands for. Each knows how far it is from the face that carries it.
class CarriedPoints {
 public:
  explicit CarriedPoints(const Mesh& mesh);

  Vec3 position(Index point) const {
    return point < vertex_count_ ? Vec3(mesh_->positions[point]) : Vec3(centroids_[point - vertex_count_]);
  }
  Index first(Index face) const { return first_[face]; }
  Index next(Index point) const { return next_[point]; }
  void add(Index face, Index point) {
    next_[point] = first_[face];
    first_[face] = point;
  }
  float squared_distance(Index point) const { return squared_distance_[point]; }
  void set_squared_distance(Index point, float squared_distance) { squared_distance_[point] = squared_distance; }
  float weight(Index point) const { return weight_[point]; }
  void set_weight(Index point, float weight) { weight_[point] = weight; }
  void clear(Index face) { first_[face] = kNoIndex; }

 private:
  const Mesh* mesh_;
  Index vertex_count_;
  std::vector<Vec3f> centroids_;
  std::vector<Index> first_;
  std::vector<Index> next_;
  std::vector<float> weight_;
  std::vector<float> squared_distance_;
};

}  // namespace lodestone::detail

#pragma once

#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// A point of the full mesh that some face stands for.
struct CarriedPoint {
  Vec3f position;
  float weight = 1;            ///< how many points it stands for
  float squared_distance = 0;  ///< from the face that carries it
  Index next = kNoIndex;       ///< of the same face
};

/// The memory of the removed surface: points of the full mesh, each carried by the face that now stands for it.
///
/// Points are the original faces' centroids, from the start, and every vertex from its removal on. A list is kept for
/// each face slot; points 0 … vertex_count − 1 are vertices, the rest centroids.
class CarriedPoints {
 public:
  explicit CarriedPoints(const Mesh& mesh);

  /// The first point of a face; kNoIndex where there is none.
  Index first(Index face) const { return first_[face]; }
  const CarriedPoint& operator[](Index point) const { return points_[point]; }
  CarriedPoint& operator[](Index point) { return points_[point]; }
  void add(Index face, Index point) {
    points_[point].next = first_[face];
    first_[face] = point;
  }
  void clear(Index face) { first_[face] = kNoIndex; }

 private:
  std::vector<CarriedPoint> points_;
  std::vector<Index> first_;
};

}  // namespace lodestone::detail

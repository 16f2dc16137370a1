#pragma once

#include <vector>

#include "distance/point_triangle.h"
#include "simplify/carried_points.h"

namespace lodestone::detail {

/// Where the distances that a removal brings are measured: at the vertex itself, and at the points that its faces
/// carry.
struct StarPoints {
  PointBatch places;                   ///< relative to the vertex
  std::vector<float> weights;          ///< of each
  double squared_distance_before = 0;  ///< of all from the star, weighted and summed

  /// Begins with the vertex alone.
  void start() {
    places.clear();
    places.add({});
    weights.assign(1, 1.0F);
    squared_distance_before = 0;
  }
  void add_face(const CarriedPoints& carried, Index face, const Vec3& vertex) {
    for (Index p = carried.first(face); p != kNoIndex; p = carried[p].next) {
      places.add(Vec3(carried[p].position) - vertex);
      weights.push_back(carried[p].weight);
      squared_distance_before += static_cast<double>(carried[p].weight * carried[p].squared_distance);
    }
  }
};

}  // namespace lodestone::detail

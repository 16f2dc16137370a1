#pragma once

#include <limits>
#include <span>
#include <vector>

#include <lodestone/core/removal.h>

#include "distance/point_triangle.h"
#include "simplify/simplify_state.h"

namespace lodestone::detail {

/// Moves the memory of the removed surface along with removals that have just been done: the points of a star's faces,
/// and the removed vertex, to the nearest of the new faces.
///
/// Keeps scratch memory of one star: one object for each thread.
class PointCarrier {
 public:
  /// The state outlives the object.
  explicit PointCarrier(SimplifyState& state) : state_(&state) {}

  void carry(const RemovalRecord& record);

 private:
  /// A face that a point is given to, and how far it is from there.
  struct Heir {
    Index face = kNoIndex;
    float squared_distance = std::numeric_limits<float>::infinity();
  };

  void take_points(const SectorPatch& sector);
  void find_heirs(const RemovalRecord& record, const SectorPatch& sector);
  void choose_nearest(const Vec3& origin);
  void give_points();
  void thin();

  SimplifyState* state_;
  std::vector<Index> taken_;  // points of the faces that went
  std::vector<Index> faces_;  // that take over from them
  std::vector<Heir> heir_;    // of each point
  std::vector<Index> members_;
  PointBatch batch_;
  std::vector<float> distance_;
};

}  // namespace lodestone::detail

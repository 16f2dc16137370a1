#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// How an object is seen, in perspective.
struct ObjectView {
  double screen_height = 1080;  ///< of the picture, pixels
  double field_of_view = 0.8;   ///< from its lower edge to its upper one, radians, in (0, π)
  double distance = 1;          ///< from the eye to the object's nearest point, world units
  double scale = 1;             ///< world units in a mesh unit; where axes differ, the most
};

/// Returns how many pixels a distance of one mesh unit covers:
///
///     scale · screen_height / (2 · distance · tan(field_of_view / 2))
///
/// It is exact for what lies across the line of sight, at the object's nearest point, in the middle of the picture.
/// What is farther away or lies along the line of sight covers less; off the middle by an angle α, the picture
/// stretches it by up to 1 / cos² α. Infinity where the distance is not above 0: the eye is in the object.
double pixels_per_unit(const ObjectView& view);

/// Chooses a position by what its level may deviate, and stays where it is while that is fine enough and not much too
/// fine: a camera that trembles moves nothing.
class DetailChoice {
 public:
  /// `slack`: how many times finer than asked for a level may be before a coarser one is chosen, ≥ 1. Pre: `mesh` is
  /// valid and outlives the choice; records may be appended to it.
  explicit DetailChoice(const ProgressiveMesh& mesh, double slack = 1.3) : mesh_(&mesh), slack_(slack) {}

  /// Returns the coarsest whole position whose deviation bound is at most `deviation` (mesh units), or the last that
  /// there is so far. Cost: a binary search; what has been appended is looked at once.
  Index coarsest(double deviation);

  /// Returns where to go from `position` for levels of at most `deviation`: nowhere while it stands between the
  /// coarsest position for that and the coarsest for a deviation `slack` times smaller, else to the nearer of the two.
  Index choose(Index position, double deviation);

 private:
  void look();

  const ProgressiveMesh* mesh_;
  double slack_;
  std::size_t looked_at_ = 0;
  std::vector<Index> better_;  // positions that deviate less than all before them, ascending
};

}  // namespace lodestone

#pragma once

#include <limits>
#include <memory>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/deviation.h>

namespace lodestone {

/// Measures how far one level after another of a mesh is from it, each time starting from what was proved the last
/// time.
///
/// Faces are recognised by their corners' positions. A face that a level shares with the original deviates by 0; one
/// that it shares with the level before keeps the bound it had; and what was near a face that is still there is no
/// farther than it was. So only the surroundings of what changed are looked at, and of those only what may be the
/// maximum. Any levels in any order give correct results; levels that change little at a time give them quickly.
class LevelDeviation {
 public:
  /// Pre: `original` outlives the object. Cost: O(n log n).
  explicit LevelDeviation(const Mesh& original, const DeviationOptions& options = {});
  ~LevelDeviation();
  LevelDeviation(LevelDeviation&&) noexcept;
  LevelDeviation& operator=(LevelDeviation&&) noexcept;

  /// Measures the two-sided maximum, narrowed as the options and `enough` say; as `measure_maximum` does.
  /// `moved`, if it is known, bounds the distance of the previous level's points from this level, in mesh units.
  Deviation measure(const Mesh& level, double moved = std::numeric_limits<double>::infinity(), double enough = 0);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone

#pragma once

#include <array>
#include <limits>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>
#include <lodestone/lod/surface_index.h>

#include "distance/surface_walk.h"
#include "fit/fit_samples.h"

namespace lodestone::detail {

/// Whether a triangle may replace one of normal `before` (of any length): it does not turn far, nor is it a sliver.
bool is_upright(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& before);

/// Puts back vertices whose new positions would turn faces over or make them slivers, until none does.
void keep_faces_upright(const Mesh& mesh, std::vector<Vec3f>& positions);

/// Keeps the faces of a level that is being fitted near the original, and facing as it does, by some points of each. A
/// face is looked at again once it has moved so far that it may be out of reach, or has turned; that another sheet may
/// have become the nearer one meanwhile is let pass.
class OriginalGuard {
 public:
  /// `index` and `walk` are the original's; each face looked at is one of the steps, and once these are cancelled none
  /// is. All outlive the guard.
  OriginalGuard(const Mesh& original, const SurfaceIndex& index, const SurfaceWalk& walk, ProgressSteps& steps)
      : original_(original), index_(index), walk_(walk), steps_(steps) {}

  /// How a level's faces lie to the original, by some points of each.
  struct Survey {
    double farthest = 0;  ///< distance
    double error = 0;     ///< a norm, summed over the points, each with the area it stands for
  };
  Survey survey(const Mesh& level, const SampleNorm& norm);

  /// From now on no face may be farther than that from the original.
  void set_reach(double reach) { reach_ = reach; }

  /// Puts back vertices of faces that their new positions would take out of reach, or turn away from the original;
  /// returns whether there was none.
  bool keep_faces_near(const Mesh& level, std::vector<Vec3f>& positions);

  using Corners = std::array<Vec3, 3>;

  /// Whether two faces may replace two others: within reach, and none looks away from the original where none did.
  bool lets_pass(const std::array<Corners, 2>& now, const std::array<Corners, 2>& before) const;

 private:
  static constexpr std::size_t kPointsOfFace = 8;  // at which the original near a face is looked up

  struct Nearest {
    Index face;
    double distance;
  };

  /// How a face stood to the original when it was last looked at.
  struct Standing {
    std::array<Vec3f, 3> corners;                               // which they were before they became Corners
    double distance = std::numeric_limits<double>::infinity();  // of the farthest of its points
    double facing = -1;     // the cosine of the least angle between its normal and the original's at one of its points
    Index near = kNoIndex;  // an original face there
  };
  using Distances = std::array<double, kPointsOfFace>;  // of the points of a face that are not corners

  static Corners corners_of(const Mesh& level, Index face, const std::vector<Vec3f>& positions);
  Standing look_at(const Corners& corners, Index near, Distances* inside = nullptr) const;
  Nearest nearest(const Vec3& point, Index near) const;
  bool is_surely_fine(const Standing& last, const Corners& corners) const;

  const Mesh& original_;
  const SurfaceIndex& index_;
  const SurfaceWalk& walk_;
  ProgressSteps& steps_;
  double reach_ = std::numeric_limits<double>::infinity();
  std::vector<Standing> standing_;  // by face
};

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>

#include "distance/face_boxes.h"
#include "distance/surface_walk.h"
#include "fit/fit_samples.h"

namespace lodestone::detail {

/// Whether a triangle may replace one of normal `before` (of any length): it does not turn far, nor is it a sliver.
bool is_upright(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& before);

using Corners = std::array<Vec3, 3>;

inline Corners corners_at(const Mesh& mesh, const std::vector<Vec3f>& positions, Index face) {
  return {Vec3(positions[mesh.corner_vertex(3 * face)]), Vec3(positions[mesh.corner_vertex(3 * face + 1)]),
          Vec3(positions[mesh.corner_vertex(3 * face + 2)])};
}

/// New positions for the vertices of a level, some of which are put back where they were. What looks for such faces
/// again and again asks which have changed since it looked at them last, by a time that starts at `kStart`.
class TentativeMoves {
 public:
  static constexpr Index kStart = 1;

  /// The level outlives it and stays as it is.
  TentativeMoves(const Mesh& level, std::vector<Vec3f> positions);

  const Mesh& level() const { return level_; }
  std::vector<Vec3f> take_positions() { return std::move(positions_); }
  Corners before(Index face) const { return corners_at(level_, level_.positions, face); }
  Corners now(Index face) const { return corners_at(level_, positions_, face); }

  /// Whether a face has moved at all, and a vertex of it has changed its position at that time or later.
  bool has_news(Index face, Index time) const;
  /// Begins a time that is later than all before.
  Index next_time() { return ++time_; }
  /// Puts back the vertices of a face.
  void put_back(Index face);

 private:
  bool is_moved(Index vertex) const { return !(positions_[vertex] == level_.positions[vertex]); }

  const Mesh& level_;
  std::vector<Vec3f> positions_;
  std::vector<Index> changed_at_;  // by vertex
  Index time_ = kStart;
};

/// Puts back vertices whose new positions would turn faces over or make them slivers, until none does. `looked_at` is
/// when that was done last, and is set to now.
void keep_faces_upright(TentativeMoves& moves, Index& looked_at);

/// Keeps the faces of a level that is being fitted near the original, and facing as it does, by some points of each. A
/// face is looked at again once it has moved so far that it may be out of reach, or has turned; that another sheet may
/// have become the nearer one meanwhile is let pass.
class OriginalGuard {
 public:
  /// Both are the original's; each face looked at is one of the steps, and once these are cancelled none is. All
  /// outlive the guard.
  OriginalGuard(const FaceBoxes& boxes, const SurfaceWalk& walk, ProgressSteps& steps)
      : boxes_(boxes), walk_(walk), steps_(steps) {}

  /// How a level's faces lie to the original, by some points inside each.
  struct Survey {
    double farthest = 0;  ///< distance
    double error = 0;     ///< a norm, summed over the points, each with the area it stands for
  };
  Survey survey(const Mesh& level, const SampleNorm& norm);

  /// Says on which of the original's faces a corner of each of the level's lies; kNoIndex where that is not known.
  void start_from(const std::vector<Index>& faces);

  /// From now on no face may be farther than that from the original.
  void set_reach(double reach) { reach_ = reach; }

  /// Puts back vertices of faces that their new positions would take out of reach, or turn away from the original;
  /// returns whether there was none. `looked_at` is when that was done last, and is set to now.
  bool keep_faces_near(TentativeMoves& moves, Index& looked_at);

  /// Whether two faces may replace two others, whose numbers are given: within reach, and none looks away from the
  /// original where none did.
  bool lets_pass(const std::array<Corners, 2>& now, const std::array<Corners, 2>& before,
                 const std::array<Index, 2>& faces) const;

 private:
  static constexpr std::size_t kPointsOfFace = 8;  // at which the original near a face is looked up

  /// How a face stood to the original when it was last looked at.
  struct Standing {
    Standing() = default;
    Standing(const Corners& c, Index face_near);

    std::array<Vec3f, 3> corners;  // which they were before they became Corners
    double distance = 0;           // of the farthest of its points
    double facing = -1;     // the cosine of the least angle between its normal and the original's at one of its points
    Index near = kNoIndex;  // an original face there
  };
  using Distances = std::array<double, kPointsOfFace>;  // of the points of a face that are not corners

  Standing look_at(const Corners& corners, Index near) const;
  double visit(const Vec3& point, Standing& standing) const;
  Distances look_inside(Standing& standing) const;
  NearFace nearest(const Vec3& point, Index near) const;
  bool is_surely_fine(const Standing& last, const Corners& corners) const;

  const FaceBoxes& boxes_;
  const SurfaceWalk& walk_;
  ProgressSteps& steps_;
  double reach_ = std::numeric_limits<double>::infinity();
  std::vector<Standing> standing_;  // by face
};

}  // namespace lodestone::detail

#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/lod/deviation.h>

#include "distance/face_change.h"
#include "distance/face_history.h"
#include "distance/patch_bound.h"
#include "distance/supremum.h"
#include "distance/target_surface.h"

namespace lodestone::detail {

/// Bounds how far what removals leave of a mesh is from it, both ways, and measures that from time to time, each time
/// starting from what was proved before.
///
/// The bound of a face of the original rests on some faces of the level. While these are there it stays, and where
/// removals have taken them it has grown by no more than what they moved the surface there. So only what may be the
/// maximum after that is looked at again. Faces of a level are named by those of the original whose places they have.
class LevelDeviation {
 public:
  /// Pre: `original` outlives the object; no face has been removed. Cost: O(n).
  LevelDeviation(const Mesh& original, const DeviationOptions& options);

  /// The faces that are left of the original, and the vertices that they use.
  struct Level {
    Level(const Mesh& original, const Connectivity& current);

    Mesh mesh;
    std::vector<Index> source;    ///< by vertex: the original's
    std::vector<Index> slots;     ///< by face: its name
    std::vector<Index> opposite;  ///< the mesh's opposite_corners, as they are known already
  };

  /// Takes into account what a removal did, or that a piece has vanished.
  void add(const FaceChange& change);
  /// The two-sided distance is no more, mesh units.
  double bound() const;

  /// Measures the two-sided maximum, narrowed as the options say; as `measure_maximum` does.
  /// Pre: `level` is what all that was added has left of the original, and has faces.
  Deviation measure(const Level& level);

 private:
  void carry(std::span<const Index> numbers);
  void carry_vertices(std::span<const Index> numbers, std::span<const FaceHistory::Fate> fates);
  void carry_faces(std::span<const Index> faces, std::span<const FaceHistory::Fate> fates);
  SurfaceBounds place_vertices(const Level& level);
  void keep(const Level& level, const SurfaceBounds& backward);

  const Mesh& original_;
  DeviationOptions options_;
  double diagonal_;              // the original's
  std::vector<Index> opposite_;  // of the original's corners
  TargetSurface surface_;
  PatchBound patch_;
  std::vector<Index> face_at_;  // by the original's vertices, a face; kNoIndex: none
  FaceHistory history_;
  double measured_ = 0;     // the last time
  FaceReach moved_;         // of the original's points: since then
  FaceReach moved_in_all_;  // and since the begin

  // Of the original's faces, to the level.
  SurfaceBounds forward_;
  std::vector<float> proved_;  // the bound when it was last looked at,
  std::vector<Index> since_;   // and the period that began then

  FaceReach backward_;  // of the level's faces, to the original

  Vec3 farthest_point_;             // of the original, from the level when it was last measured
  Index farthest_face_ = kNoIndex;  // of that level, from the original
  double farthest_distance_ = 0;    // of farthest_face_
};

}  // namespace lodestone::detail

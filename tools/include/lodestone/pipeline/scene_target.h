#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/progressive_mesh.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/level_target.h>

namespace lodestone {

/// A progressive mesh in a scene.
struct ScenePart {
  const ProgressiveMesh* mesh = nullptr;
  double scale = 1;                ///< world units per mesh unit
  std::size_t instance_count = 1;  ///< how often it is drawn
  StopReason end = StopReason::Stuck;
  double importance = 1;  ///< where parts share faces: multiplies what its faces are worth
  /// By position, falling from coarse to fine: what is lost there, in a unit that all parts share. Empty: the
  /// deviation.
  std::vector<double> loss;
  /// Returns what a level at a position really deviates by, in mesh units, where bounds say that it is too much; empty:
  /// bounds are believed.
  std::function<double(Index)> measure;
  /// How often `measure` may be asked, at most, whether a level by error can be coarser than bounds say.
  int probe_count = 0;
  double displacement = 0;  ///< how far a file moves its vertices beyond the stream's deviations, mesh units
};

/// What a target counts over.
enum class TargetScope {
  Scene,  ///< the drawn faces of all meshes together, and one error in world units
  Mesh,   ///< each mesh by itself
};

/// The levels of all parts that answer a target together.
struct SceneChoice {
  LevelTarget target;            ///< in absolute numbers where its scope is the scene
  std::vector<Index> positions;  ///< one for each part
  bool met = true;
  std::string stopped_by;  ///< why the level is no coarser: faces, error, epsilon; or stuck
  /// By part, where it is stopped by an error though faces are asked for: the deviation bound, in mesh units, of the
  /// level that comes nearest to the target. Else empty.
  std::vector<double> beyond;
};

/// Finds the positions that answer a target. Faces go where they are worth most: all parts get the coarsest level
/// within one loss, the smallest for which the faces suffice, and what is left goes to whichever part has lost most.
/// Where the faces do not suffice, as some parts cannot have so few, the others get their share of what those would
/// have got, and no part goes on where its error leaps (see `position_before_leap`), by its bound and as it is
/// measured. A target that is a wish gives way, too, where meeting it makes a part's error leap. `diagonal` is the
/// scene's.
SceneChoice choose_positions(std::span<const ScenePart> parts, const LevelTarget& target, TargetScope scope,
                             double diagonal);

/// Takes a choice back to where it keeps to an error, if it does not, by bounds or as measured; it answers that then.
/// Pre: `limit` is an error.
void keep_within(std::span<const ScenePart> parts, const LevelTarget& limit, TargetScope scope, double diagonal,
                 SceneChoice& choice);

}  // namespace lodestone

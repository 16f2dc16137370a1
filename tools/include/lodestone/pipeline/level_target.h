#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/lod/progressive_mesh.h>
#include <lodestone/lod/simplify.h>

namespace lodestone {

/// What a target limits.
enum class TargetKind {
  Faces,    ///< at most so many faces
  Error,    ///< at most so much deviation
  Epsilon,  ///< at most so much curvature error
};

/// What a level has to keep to.
struct LevelTarget {
  TargetKind kind = TargetKind::Faces;  ///< says what `value` is
  double value = 0;       ///< faces, mesh units, or the metric's own unit; a share of the whole if relative
  bool relative = false;  ///< to the full face count (Faces) or to the bounding-box diagonal (Error)
  bool is_wish = false;   ///< of the default series: a level stops before its error leaps
};

/// Returns `count` targets, each of so many times the faces of the one before, that stop before their error leaps.
std::vector<LevelTarget> ratio_targets(double ratio, int count);

/// What relative targets are relative to.
struct FullSize {
  std::size_t face_count = 0;  ///< of the whole mesh or scene, as the next
  double diagonal = 0;         ///< of its box, in its units
};

/// The level of a progressive mesh that answers a target.
struct LevelChoice {
  LevelTarget target;
  Index position = 0;
  bool met = true;
  std::string stopped_by;  ///< why the level is no coarser: faces, error, epsilon; or stuck
};

/// Returns the target in absolute numbers; a share of the faces is rounded down, but to one face, unless it is 0.
LevelTarget resolve(const LevelTarget& target, const FullSize& full);

/// Finds the level that answers an absolute target; an error of 0 is the whole mesh.
/// `end` says why the stream goes no further down than its base mesh.
LevelChoice choose_level(const ProgressiveMesh& mesh, const LevelTarget& target, StopReason end);

/// Returns the word reports use: faces, error, epsilon, stuck or cancelled.
std::string_view name_of(StopReason reason);
/// Returns the word reports and options use: faces, error or epsilon.
std::string_view name_of(TargetKind kind);

}  // namespace lodestone

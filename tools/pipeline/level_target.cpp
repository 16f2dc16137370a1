#include <lodestone/pipeline/level_target.h>

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

Index position_for(const ProgressiveMesh& mesh, const LevelTarget& target) {
  switch (target.kind) {
    case TargetKind::Faces:
      return position_for_faces(mesh, static_cast<std::uint64_t>(target.value));
    case TargetKind::Error:
      // A removal inside a plane has no deviation either, so an error of 0 needs its own rule to be the whole mesh.
      if (target.value == 0) return static_cast<Index>(mesh.record_count());
      return position_for_deviation(mesh, target.value);
    case TargetKind::Epsilon:
      return position_for_curvature_error(mesh, target.value);
  }
  return 0;
}

}  // namespace

std::vector<LevelTarget> ratio_targets(double ratio, int count) {
  std::vector<LevelTarget> targets;
  for (int i = 1; i <= count; ++i) targets.push_back({TargetKind::Faces, std::pow(ratio, i), true, true});
  return targets;
}

LevelTarget resolve(const LevelTarget& target, const FullSize& full) {
  if (!target.relative) return target;
  if (target.kind == TargetKind::Error) return {target.kind, target.value * full.diagonal, false, target.is_wish};
  // 0.29 of 100 is 29, though the product of the doubles falls just short of it. Of few faces a share is one at least.
  const double faces = std::floor(target.value * static_cast<double>(full.face_count) * (1 + 1e-12));
  return {target.kind, target.value > 0 ? std::max(faces, 1.0) : faces, false, target.is_wish};
}

LevelChoice choose_level(const ProgressiveMesh& mesh, const LevelTarget& target, StopReason end) {
  LevelChoice choice{target, position_for(mesh, target), true, std::string(name_of(target.kind))};
  if (choice.position > 0) return choice;
  if (target.kind == TargetKind::Faces) {
    choice.met = static_cast<double>(face_counts(mesh).front()) <= target.value;
    if (choice.met) return choice;
  }
  choice.stopped_by = name_of(end);
  return choice;
}

std::string_view name_of(StopReason reason) {
  switch (reason) {
    case StopReason::Faces:
      return "faces";
    case StopReason::CurvatureError:
      return "epsilon";
    case StopReason::Deviation:
      return "error";
    case StopReason::Stuck:
      return "stuck";
    case StopReason::Cancelled:
      return "cancelled";
  }
  return "unknown";
}

std::string_view name_of(TargetKind kind) {
  switch (kind) {
    case TargetKind::Faces:
      return "faces";
    case TargetKind::Error:
      return "error";
    case TargetKind::Epsilon:
      return "epsilon";
  }
  return "unknown";
}

}  // namespace lodestone

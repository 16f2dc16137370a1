#include <lodestone/pipeline/scene_target.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <queue>

#include "pipeline/error_leap.h"

namespace lodestone {
namespace {

using namespace detail;

/// Makes errors fall from coarse to fine: bounds of deviations alone need not.
std::vector<double> falling(std::vector<double> errors) {
  for (std::size_t p = errors.size() - 1; p-- > 0;) errors[p] = std::max(errors[p], errors[p + 1]);
  return errors;
}

std::vector<double> deviations(const ScenePart& part) {
  return falling({part.mesh->deviation.begin(), part.mesh->deviation.end()});
}

/// What is lost at a part's positions, in the unit that all parts share.
std::vector<double> falling_losses(const ScenePart& part) {
  std::vector<double> losses = part.loss;
  if (losses.empty()) {
    losses = deviations(part);
    for (double& loss : losses) loss *= part.scale;
  }
  for (double& loss : losses) loss *= part.importance;
  return falling(std::move(losses));
}

/// Of the whole mesh, which uses every vertex.
double diagonal_of(const ProgressiveMesh& mesh) {
  if (mesh.positions.empty()) return 0;
  Vec3f low = mesh.positions.front(), high = low;
  for (const Vec3f& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return length(Vec3(high) - Vec3(low));
}

/// A part's faces and errors by position.
struct PartCurve {
  PartCurve(const ScenePart& part, TargetScope scope, double scene_diagonal)
      : faces(face_counts(*part.mesh)), errors(deviations(part)) {
    size.mesh = diagonal_of(*part.mesh);
    size.scene = scope == TargetScope::Scene ? scene_diagonal / part.scale : size.mesh;
    // Only what may vanish has a base without faces, and vanishing is no leap then.
    if (faces.front() > 0) before_leap = position_before_leap(*part.mesh, faces, errors, size);
  }

  /// Goes on towards a position beyond the leap, half of the faces at a time, where bounds are only loose.
  void look_closer(const ScenePart& part, Index position) {
    while (position < before_leap && part.measure) {
      const Index half = (faces[before_leap] + 1) / 2;
      const auto first = std::lower_bound(faces.begin(), faces.end(), half);
      Index next = std::max(position, static_cast<Index>(first - faces.begin()));
      while (!is_whole(*part.mesh, next)) ++next;
      if (next >= before_leap) return;
      const double measured = part.measure(next);
      if (is_leap(measured, next, faces, errors, size)) return;
      for (Index p = next; p < before_leap; ++p) errors[p] = std::min(errors[p], measured);
      before_leap = next;
    }
  }

  std::vector<Index> faces;
  std::vector<double> errors;  // mesh units
  LeapScale size;
  Index before_leap = 0;
};

std::vector<PartCurve> curves_of(std::span<const ScenePart> parts, TargetScope scope, double scene_diagonal) {
  std::vector<PartCurve> curves;
  for (const ScenePart& part : parts) curves.emplace_back(part, scope, scene_diagonal);
  return curves;
}

/// Shares a number of faces among the parts, none of which goes below its floor.
class FaceBudget {
 public:
  FaceBudget(std::span<const ScenePart> parts, std::span<const PartCurve> curves, std::vector<Index> floors)
      : parts_(parts), curves_(curves), floors_(std::move(floors)) {
    for (const ScenePart& part : parts) losses_.push_back(falling_losses(part));
  }

  /// Returns the faces that are drawn at the positions given.
  std::size_t drawn(std::span<const Index> positions) const {
    std::size_t faces = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) faces += curves_[i].faces[positions[i]] * parts_[i].instance_count;
    return faces;
  }

  bool can_meet(double budget) const { return static_cast<double>(drawn(floors_)) <= budget; }

  /// Returns a share of each part's faces, or those of its floor where they are more: what the parts draw that cannot
  /// have so few faces does not burden the others.
  double fair(double share) const {
    double faces = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const double own = std::floor(share * curves_[i].faces.back() * (1 + 1e-12));
      const auto fewest = static_cast<double>(curves_[i].faces[floors_[i]]);
      faces += std::max(own, fewest) * static_cast<double>(parts_[i].instance_count);
    }
    return faces;
  }

  /// Returns the positions within the budget, or the floors where even those exceed it.
  std::vector<Index> share(double budget) const {
    std::vector<double> thresholds;
    for (const auto& losses : losses_) thresholds.insert(thresholds.end(), losses.begin(), losses.end());
    std::sort(thresholds.begin(), thresholds.end());
    const auto enough = std::partition_point(thresholds.begin(), thresholds.end(), [&](double threshold) {
      return static_cast<double>(drawn(within(threshold))) > budget;
    });
    if (enough == thresholds.end()) return floors_;
    std::vector<Index> positions = within(*enough);
    spend(positions, budget);
    return positions;
  }

 private:
  std::vector<Index> within(double threshold) const {
    std::vector<Index> positions;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const auto first =
          std::partition_point(losses_[i].begin(), losses_[i].end(), [&](double e) { return e > threshold; });
      positions.push_back(std::max(floors_[i], static_cast<Index>(first - losses_[i].begin())));
    }
    return positions;
  }

  /// Refines the worst part again and again, as long as its next record fits; leaves no part with half a piece.
  void spend(std::vector<Index>& positions, double budget) const {
    struct Candidate {
      double loss;
      std::size_t part;
      bool operator<(const Candidate& other) const {
        return loss != other.loss ? loss < other.loss : part > other.part;
      }
    };
    std::priority_queue<Candidate> queue;
    for (std::size_t i = 0; i < parts_.size(); ++i) queue.push({losses_[i][positions[i]], i});
    auto left = budget - static_cast<double>(drawn(positions));
    while (!queue.empty()) {
      const std::size_t i = queue.top().part;
      queue.pop();
      Index& position = positions[i];
      const std::vector<Index>& faces = curves_[i].faces;
      if (position + 1 >= faces.size()) continue;
      const auto cost = static_cast<double>((faces[position + 1] - faces[position]) * parts_[i].instance_count);
      if (cost > left) continue;
      left -= cost;
      queue.push({losses_[i][++position], i});
    }
    for (std::size_t i = 0; i < parts_.size(); ++i)
      while (!is_whole(*parts_[i].mesh, positions[i])) --positions[i];
  }

  std::span<const ScenePart> parts_;
  std::span<const PartCurve> curves_;
  std::vector<Index> floors_;
  std::vector<std::vector<double>> losses_;
};

/// Notes that an error stopped a level, unless it is as coarse as can be.
void note_stop(std::span<const ScenePart> parts, std::span<const PartCurve> curves, std::span<const Index> beyond,
               SceneChoice& choice) {
  choice.met = false;
  choice.stopped_by = parts.empty() ? "stuck" : name_of(parts[0].end);
  if (std::equal(beyond.begin(), beyond.end(), choice.positions.begin())) return;
  choice.stopped_by = name_of(StopReason::Deviation);
  for (std::size_t i = 0; i < parts.size(); ++i) choice.beyond.push_back(curves[i].errors[beyond[i]]);
}

bool is_burdened(std::span<const PartCurve> curves, std::span<const Index> positions, std::span<const Index> alone) {
  for (std::size_t i = 0; i < curves.size(); ++i)
    if (is_burdened(curves[i].errors[positions[i]], curves[i].errors[alone[i]], curves[i].size)) return true;
  return false;
}

SceneChoice share_faces(std::span<const ScenePart> parts, const LevelTarget& target, double diagonal) {
  std::vector<PartCurve> curves = curves_of(parts, TargetScope::Scene, diagonal);
  std::vector<Index> whole, before_leap;
  for (const PartCurve& curve : curves) whole.push_back(static_cast<Index>(curve.faces.size() - 1));
  const FaceBudget free(parts, curves, std::vector<Index>(parts.size(), 0));
  const std::size_t full = free.drawn(whole);
  SceneChoice choice{resolve(target, {full, diagonal}), {}, true, std::string(name_of(target.kind)), {}};
  const double budget = choice.target.value;
  const std::vector<Index> nearest = free.share(budget);
  choice.positions = nearest;
  if (!target.is_wish && free.can_meet(budget)) return choice;

  for (std::size_t i = 0; i < parts.size(); ++i) {
    curves[i].look_closer(parts[i], nearest[i]);
    before_leap.push_back(curves[i].before_leap);
  }
  const FaceBudget guarded(parts, curves, before_leap);
  const std::vector<Index> fair = guarded.share(std::max(budget, guarded.fair(budget / static_cast<double>(full))));
  choice.positions = guarded.share(budget);
  if (guarded.can_meet(budget) && !is_burdened(curves, choice.positions, fair)) return choice;
  choice.positions = fair;
  note_stop(parts, curves, nearest, choice);
  return choice;
}

/// The absolute target, in mesh units, that one comes to for a part; relative ones are to the part itself.
LevelTarget target_of_part(const ScenePart& part, const LevelTarget& target) {
  FullSize full;
  if (target.relative && target.kind == TargetKind::Faces) full.face_count = face_counts(*part.mesh).back();
  if (target.relative && target.kind == TargetKind::Error) full.diagonal = diagonal_of(*part.mesh);
  LevelTarget absolute = resolve(target, full);
  if (target.kind == TargetKind::Error && !target.relative) absolute.value /= part.scale;
  return absolute;
}

/// Goes on from where bounds end to where what is measured does: errors grow about as faces get fewer, so that the
/// first guess is near, and the next lie between what kept to the error and what did not.
Index go_on_measuring(const ScenePart& part, Index position, double error) {
  constexpr double kNearEnough = 0.95;
  const std::vector<Index> faces = face_counts(*part.mesh);
  const auto size = [&](Index at) { return static_cast<double>(faces[at]); };
  Index good = position, bad = 0;
  double reached = error > 0 && part.probe_count > 0 ? part.measure(good) : error;
  for (int i = 0; i < part.probe_count && good > 0 && reached > 0 && reached < kNearEnough * error; ++i) {
    const double guess = std::max(size(good) * std::max(reached / error, 0.5), std::sqrt(size(bad) * size(good)));
    const Index next = position_for_faces(*part.mesh, static_cast<std::uint64_t>(guess));
    if (next >= good || next <= bad) break;
    const double measured = part.measure(next);
    if (measured > error) {
      bad = next;
    } else {
      good = next;
      reached = measured;
    }
  }
  return good;
}

/// Answers a target that is relative to the part itself; errors are world units.
LevelChoice choose_for_part(const ScenePart& part, const LevelTarget& target) {
  LevelTarget absolute = target_of_part(part, target);
  if (target.kind != TargetKind::Error) return choose_level(*part.mesh, absolute, part.end);
  if (absolute.value < part.displacement)
    return {absolute, static_cast<Index>(part.mesh->record_count()), false, std::string(name_of(target.kind))};
  absolute.value -= part.displacement;
  LevelChoice choice = choose_level(*part.mesh, absolute, part.end);
  if (part.measure) choice.position = go_on_measuring(part, choice.position, absolute.value);
  return choice;
}

SceneChoice choose_each(std::span<const ScenePart> parts, const LevelTarget& target) {
  SceneChoice choice{target, {}, true, std::string(name_of(target.kind)), {}};
  bool all_stopped = !parts.empty();
  for (const ScenePart& part : parts) {
    const LevelChoice own = choose_for_part(part, target);
    choice.positions.push_back(own.position);
    choice.met &= own.met;
    all_stopped &= own.stopped_by != name_of(target.kind);
  }
  if (all_stopped) choice.stopped_by = name_of(parts[0].end);
  return choice;
}

/// Faces for each part by itself.
SceneChoice choose_faces_of_each(std::span<const ScenePart> parts, const LevelTarget& target) {
  SceneChoice choice = choose_each(parts, target);
  if (choice.met && !target.is_wish) return choice;
  std::vector<PartCurve> curves = curves_of(parts, TargetScope::Mesh, 0);
  const std::vector<Index> nearest = choice.positions;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!target.is_wish && choose_for_part(parts[i], target).met) continue;
    curves[i].look_closer(parts[i], nearest[i]);
    choice.positions[i] = std::max(choice.positions[i], curves[i].before_leap);
  }
  if (choice.positions != nearest) note_stop(parts, curves, nearest, choice);
  return choice;
}

}  // namespace

void keep_within(std::span<const ScenePart> parts, const LevelTarget& limit, TargetScope scope, double diagonal,
                 SceneChoice& choice) {
  const LevelTarget target = scope == TargetScope::Mesh ? limit : resolve(limit, {0, diagonal});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ScenePart& part = parts[i];
    Index& position = choice.positions[i];
    const double error = target_of_part(part, target).value - part.displacement;
    if (part.mesh->deviation[position] <= error || (part.measure && part.measure(position) <= error)) continue;
    const LevelChoice within = choose_for_part(part, target);
    if (within.position <= position) continue;
    position = within.position;
    choice.target = target;
    choice.met = within.met;
    choice.stopped_by = within.stopped_by;
    choice.beyond.clear();
  }
}

SceneChoice choose_positions(std::span<const ScenePart> parts, const LevelTarget& target, TargetScope scope,
                             double diagonal) {
  const bool by_faces = target.kind == TargetKind::Faces;
  if (scope == TargetScope::Mesh) return by_faces ? choose_faces_of_each(parts, target) : choose_each(parts, target);
  return by_faces ? share_faces(parts, target, diagonal) : choose_each(parts, resolve(target, {0, diagonal}));
}

}  // namespace lodestone

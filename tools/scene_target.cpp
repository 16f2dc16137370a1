#include "scene_target.h"

#include <algorithm>
#include <queue>

#include <lodestone/lod/cursor.h>

namespace lodestone::tool {
namespace {

/// What is lost at a part's positions, made to fall from coarse to fine: bounds of deviations alone need not.
std::vector<double> falling_losses(const ScenePart& part) {
  std::vector<double> errors = part.loss;
  if (errors.empty()) {
    errors.assign(part.mesh->deviation.begin(), part.mesh->deviation.end());
    for (double& error : errors) error *= part.scale;
  }
  for (double& error : errors) error *= part.importance;
  for (std::size_t p = errors.size() - 1; p-- > 0;) errors[p] = std::max(errors[p], errors[p + 1]);
  return errors;
}

/// Shares a number of faces among the parts.
class FaceBudget {
 public:
  explicit FaceBudget(std::span<const ScenePart> parts) : parts_(parts) {
    for (const ScenePart& part : parts) {
      errors_.push_back(falling_losses(part));
      faces_.push_back(face_counts(*part.mesh));
    }
  }

  /// Returns the faces that are drawn with every part at full detail.
  std::size_t drawn() const {
    std::size_t faces = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) faces += faces_[i].back() * parts_[i].instance_count;
    return faces;
  }

  /// Returns the faces that are drawn at the positions given.
  std::size_t drawn(std::span<const Index> positions) const {
    std::size_t faces = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) faces += faces_[i][positions[i]] * parts_[i].instance_count;
    return faces;
  }

  /// Returns the positions within the budget, or the coarsest ones where even those exceed it.
  std::vector<Index> share(double budget) const {
    std::vector<double> thresholds;
    for (const auto& errors : errors_) thresholds.insert(thresholds.end(), errors.begin(), errors.end());
    std::sort(thresholds.begin(), thresholds.end());
    const auto enough = std::partition_point(thresholds.begin(), thresholds.end(), [&](double threshold) {
      return static_cast<double>(drawn(within(threshold))) > budget;
    });
    if (enough == thresholds.end()) return std::vector<Index>(parts_.size(), 0);
    std::vector<Index> positions = within(*enough);
    spend(positions, budget);
    return positions;
  }

 private:
  std::vector<Index> within(double threshold) const {
    std::vector<Index> positions;
    for (const auto& errors : errors_)
      positions.push_back(static_cast<Index>(
          std::partition_point(errors.begin(), errors.end(), [&](double e) { return e > threshold; }) -
          errors.begin()));
    return positions;
  }

  /// Refines the worst part again and again, as long as its next record fits; leaves no part with half a piece.
  void spend(std::vector<Index>& positions, double budget) const {
    struct Candidate {
      double error;
      std::size_t part;
      bool operator<(const Candidate& other) const {
        return error != other.error ? error < other.error : part > other.part;
      }
    };
    std::priority_queue<Candidate> queue;
    for (std::size_t i = 0; i < parts_.size(); ++i) queue.push({errors_[i][positions[i]], i});
    auto left = budget - static_cast<double>(drawn(positions));
    while (!queue.empty()) {
      const std::size_t i = queue.top().part;
      queue.pop();
      Index& position = positions[i];
      if (position + 1 >= faces_[i].size()) continue;
      const auto cost = static_cast<double>((faces_[i][position + 1] - faces_[i][position]) * parts_[i].instance_count);
      if (cost > left) continue;
      left -= cost;
      queue.push({errors_[i][++position], i});
    }
    for (std::size_t i = 0; i < parts_.size(); ++i)
      while (!is_whole(*parts_[i].mesh, positions[i])) --positions[i];
  }

  std::span<const ScenePart> parts_;
  std::vector<std::vector<double>> errors_;
  std::vector<std::vector<Index>> faces_;
};

double diagonal_of(const ProgressiveMesh& mesh) {
  Cursor cursor(mesh);
  cursor.seek(static_cast<Index>(mesh.record_count()));
  return bounding_box(extract_level(mesh, cursor)).diagonal();
}

/// Answers a target that is relative to the part itself; errors are world units.
LevelChoice choose_for_part(const ScenePart& part, const LevelTarget& target) {
  FullSize full;
  if (target.relative && target.kind == TargetKind::Faces) full.face_count = face_counts(*part.mesh).back();
  if (target.relative && target.kind == TargetKind::Error) full.diagonal = diagonal_of(*part.mesh);
  LevelTarget absolute = resolve(target, full);
  if (target.kind != TargetKind::Error) return choose_level(*part.mesh, absolute, part.end);
  if (!target.relative) absolute.value /= part.scale;
  if (absolute.value < part.displacement)
    return {absolute, static_cast<Index>(part.mesh->record_count()), false, std::string(name_of(target.kind))};
  absolute.value -= part.displacement;
  return choose_level(*part.mesh, absolute, part.end);
}

SceneChoice choose_each(std::span<const ScenePart> parts, const LevelTarget& target) {
  SceneChoice choice{target, {}, true, std::string(name_of(target.kind))};
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

}  // namespace

SceneChoice choose_positions(std::span<const ScenePart> parts, const LevelTarget& target, TargetScope scope,
                             double diagonal) {
  if (scope == TargetScope::Mesh) return choose_each(parts, target);
  if (target.kind != TargetKind::Faces) return choose_each(parts, resolve(target, {0, diagonal}));
  const FaceBudget budget(parts);
  const LevelTarget absolute = resolve(target, {budget.drawn(), diagonal});
  SceneChoice choice{absolute, budget.share(absolute.value), true, std::string(name_of(absolute.kind))};
  choice.met = static_cast<double>(budget.drawn(choice.positions)) <= absolute.value;
  if (!choice.met) choice.stopped_by = parts.empty() ? "stuck" : name_of(parts[0].end);
  return choice;
}

}  // namespace lodestone::tool

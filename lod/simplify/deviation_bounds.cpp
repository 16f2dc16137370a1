#include "simplify/deviation_bounds.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "distance/displacement.h"
#include "distance/round_up.h"

namespace lodestone::detail {
namespace {

// How far a piece that vanishes was from what is left is bounded roughly, so it is measured sooner.
constexpr double kStepAfterVanishing = 0.01;

// The mesh has so many times the faces of all levels together that wait to be measured.
constexpr std::size_t kFullOfWaiting = 4;

DeviationOptions measuring_options(const Progress& progress) {
  DeviationOptions options;
  options.relative_tolerance = 0.01;
  options.budget = 100'000;
  options.progress = progress;
  return options;
}

}  // namespace

DeviationBounds::DeviationBounds(const Mesh& full, double step, const Progress& progress)
    : full_(&full), step_(step), progress_(progress.part(0)), measured_faces_(full.face_count()), moved_(0) {
  if (step > 0 && progress_.add(0))
    level_.emplace(full, measuring_options(progress_));
  else
    moved_ = FaceReach(full.face_count());
  bound_.reserve(full.vertex_count());
}

double DeviationBounds::bound() const { return level_ ? level_->bound() : static_cast<double>(moved_.largest); }

void DeviationBounds::displacements(std::span<const RemovalRecord> copies, std::vector<double>& displacement) const {
  displacement.clear();
  for (const RemovalRecord& record : copies) displacement.push_back(displacement_bound(*full_, record));
}

void DeviationBounds::add(std::span<const RemovalRecord> copies, std::span<const double> displacement) {
  for (std::size_t i = 0; i < copies.size(); ++i) account_.changes.add(copies[i], displacement[i]);
  any_removed_ = true;
  ask();
}

void DeviationBounds::add_vanished(std::span<const RemovalRecord> records, Index face, double reach) {
  account_.changes.add_vanished(records, face, reach);
  vanished_ = any_removed_ = true;
}

/// Answers what an account asks.
void DeviationBounds::settle(const Account& account) {
  std::size_t change = 0;
  const auto settle_changes = [&](std::size_t count) {
    for (; change < count; ++change) {
      if (level_)
        level_->add(account.changes[change]);
      else
        moved_.add(account.changes[change]);
    }
  };
  for (const Account::Question& question : account.questions) {
    settle_changes(question.change_count);
    bound_.push_back(round_up(std::max(question.least, bound())));
  }
  settle_changes(account.changes.size());
}

void DeviationBounds::settle_all() {
  measurements_.wait();
  settle(std::exchange(account_, {}));
}

void DeviationBounds::measure(const LevelDeviation::Level& level) {
  if (progress_.is_cancelled()) return;  // many levels may wait
  level_->measure(level);
  bound_.back() = round_up(std::min(static_cast<double>(bound_.back()), bound()));
}

void DeviationBounds::end_round(const Connectivity& current) {
  if (!level_) return settle_all();
  const double step = vanished_ ? std::min(step_, kStepAfterVanishing) : step_;
  const auto threshold = static_cast<double>(measured_faces_) * (1 - step);
  if (!any_removed_ || least_ > 0 || static_cast<double>(current.face_count()) > threshold) return;
  measured_faces_ = current.face_count();
  vanished_ = false;
  // Levels that wait take a part of the memory of the mesh, early none, late many.
  measurements_.wait(measured_faces_ > 0 ? full_->face_count() / (kFullOfWaiting * measured_faces_) : 0);
  // Shared, since a job can be copied.
  const auto level = std::make_shared<const LevelDeviation::Level>(*full_, current);
  const auto account = std::make_shared<const Account>(std::exchange(account_, {}));
  measurements_.add([this, level, account] {
    settle(*account);
    measure(*level);
  });
}

double DeviationBounds::current() {
  settle_all();
  return bound_.empty() ? 0 : static_cast<double>(bound_.back());
}

std::vector<float> DeviationBounds::take_bounds() {
  settle_all();
  level_.reset();
  moved_ = FaceReach(0);
  return std::exchange(bound_, {});
}

}  // namespace lodestone::detail

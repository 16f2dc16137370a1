#include "distance/deviation_bounds.h"

#include <algorithm>

#include "distance/displacement.h"

namespace lodestone::detail {
namespace {

// How far a piece that vanishes was from what is left is bounded roughly, so it is measured sooner.
constexpr double kStepAfterVanishing = 0.01;

DeviationOptions measuring_options(const Progress& progress) {
  DeviationOptions options;
  options.relative_tolerance = 0.01;
  options.budget = 100'000;
  options.progress = progress.part(0);
  return options;
}

}  // namespace

DeviationBounds::DeviationBounds(const Mesh& full, double step, const Progress& progress)
    : full_(&full), step_(step), moved_(0), measured_faces_(full.face_count()) {
  if (step > 0 && progress.add(0))
    level_.emplace(full, measuring_options(progress));
  else
    moved_ = FaceReach(full.face_count());
  bound_.reserve(full.vertex_count());
}

double DeviationBounds::bound() const {
  return std::max(last_, level_ ? level_->bound() : static_cast<double>(moved_.largest));
}

void DeviationBounds::displacements(std::span<const RemovalRecord> copies, std::vector<double>& displacement) const {
  displacement.clear();
  for (const RemovalRecord& record : copies) displacement.push_back(displacement_bound(*full_, record));
}

void DeviationBounds::add(std::span<const RemovalRecord> copies, std::span<const double> displacement) {
  for (std::size_t i = 0; i < copies.size(); ++i) {
    if (level_) {
      level_->add(copies[i], displacement[i]);
    } else {
      moved_.add(last_change_.add(copies[i], displacement[i]));
      last_change_.clear();
    }
  }
  bound_.push_back(round_up(bound()));
}

void DeviationBounds::add_vanished(std::span<const RemovalRecord> records, Index face, double reach) {
  if (level_) {
    level_->add_vanished(records, face, reach);
  } else {
    moved_.add(last_change_.add_vanished(records, face, reach));
    last_change_.clear();
  }
  vanished_ = true;
}

void DeviationBounds::end_round(const Connectivity& current) {
  const double step = vanished_ ? std::min(step_, kStepAfterVanishing) : step_;
  const auto threshold = static_cast<double>(measured_faces_) * (1 - step);
  if (!level_ || bound_.empty() || last_ > 0 || static_cast<double>(current.face_count()) > threshold) return;
  level_->measure(current);
  measured_faces_ = current.face_count();
  vanished_ = false;
  bound_.back() = round_up(std::min(static_cast<double>(bound_.back()), bound()));
}

}  // namespace lodestone::detail

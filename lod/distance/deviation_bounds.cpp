#include "distance/deviation_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <lodestone/core/detail/compaction.h>

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

/// Copies the faces that are left, and the vertices they use.
Mesh current_level(const Mesh& full, const Connectivity& current) {
  Mesh level;
  level.corner_wedge.reserve(3 * current.face_count());
  Compaction vertices(full.vertex_count());
  for (Index c = 0; c < 3 * current.face_slot_count(); ++c) {
    if (!current.has_face(face_of_corner(c))) continue;
    level.corner_wedge.push_back(vertices.add(current.vertex(c)));
  }
  level.positions = pick_entries(full.positions, vertices.used());
  level.wedge_vertex.resize(level.positions.size());
  std::iota(level.wedge_vertex.begin(), level.wedge_vertex.end(), Index{0});
  return level;
}

}  // namespace

/// Rounds up to a float, so that a bound stays one.
float DeviationBounds::round_up(double value) {
  const auto f = static_cast<float>(value);
  return static_cast<double>(f) < value ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

DeviationBounds::DeviationBounds(const Mesh& full, double step, const Progress& progress)
    : full_(&full),
      step_(step),
      measured_faces_(full.face_count()),
      since_start_(full.face_count()),
      since_measured_(0) {
  if (step > 0 && progress.add(0)) {
    level_.emplace(full, measuring_options(progress));
    since_measured_ = Chain(full.face_count());
  }
  bound_.reserve(full.vertex_count());
}

double DeviationBounds::bound() const {
  const double from_level = level_ ? measured_ + since_measured_.largest : since_start_.largest;
  return std::max(last_, std::min(from_level, since_start_.largest));
}

void DeviationBounds::displacements(std::span<const RemovalRecord> copies, std::vector<double>& displacement) const {
  displacement.clear();
  for (const RemovalRecord& record : copies) displacement.push_back(displacement_bound(*full_, record));
}

void DeviationBounds::add(std::span<const RemovalRecord> copies, std::span<const double> displacement) {
  for_chains([&](Chain& chain) {
    for (std::size_t i = 0; i < copies.size(); ++i) chain.add(copies[i], displacement[i]);
  });
  bound_.push_back(round_up(bound()));
}

void DeviationBounds::add_vanished(std::span<const RemovalRecord> records, Index face, double reach) {
  for_chains([&](Chain& chain) { chain.add_vanished(records, face, reach); });
  vanished_ = true;
}

/// What a sector's faces stood for moves with the new ones; where it has none, with those that lie at its new edge.
void DeviationBounds::Chain::add(const RemovalRecord& record, double displacement) {
  float before = 0;
  for (const SectorPatch& sector : record.sectors)
    for (const Index face : sector.faces) before = std::max(before, moved[face]);
  const float after = round_up(static_cast<double>(before) + displacement);
  for (const SectorPatch& sector : record.sectors) {
    for (std::size_t i = 0; i < sector.triangles.size(); ++i) moved[sector.faces[i]] = after;
    if (sector.lone_outer == kNoIndex) continue;
    float& beyond = moved[face_of_corner(sector.lone_outer)];
    beyond = std::max(beyond, after);
  }
  largest = std::max(largest, static_cast<double>(after));
}

void DeviationBounds::Chain::add_vanished(std::span<const RemovalRecord> records, Index face, double reach) {
  float before = 0;
  for (const RemovalRecord& record : records)
    for (const SectorPatch& sector : record.sectors)
      for (const Index gone : sector.faces) before = std::max(before, moved[gone]);
  const float after = round_up(static_cast<double>(before) + reach);
  moved[face] = std::max(moved[face], after);
  largest = std::max(largest, static_cast<double>(after));
}

void DeviationBounds::end_round(const Connectivity& current) {
  const double step = vanished_ ? std::min(step_, kStepAfterVanishing) : step_;
  const auto threshold = static_cast<double>(measured_faces_) * (1 - step);
  if (!level_ || bound_.empty() || last_ > 0 || static_cast<double>(current.face_count()) > threshold) return;
  measured_ = level_->measure(current_level(*full_, current), since_measured_.largest).maximum_bound();
  measured_faces_ = current.face_count();
  since_measured_.reset();
  vanished_ = false;
  if (last_ == 0) bound_.back() = round_up(std::min(static_cast<double>(bound_.back()), measured_));
}

}  // namespace lodestone::detail

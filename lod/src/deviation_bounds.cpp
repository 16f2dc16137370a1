#include "deviation_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "displacement.h"

namespace lodestone::detail {
namespace {

/// Rounds up to a float, so that a bound stays one.
float round_up(double value) {
  const auto f = static_cast<float>(value);
  return static_cast<double>(f) < value ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

DeviationOptions measuring_options() {
  DeviationOptions options;
  options.relative_tolerance = 0.01;
  options.budget = 100'000;
  return options;
}

/// Copies the faces that are left, and the vertices they use.
Mesh current_level(const Mesh& full, const Connectivity& current) {
  Mesh level;
  std::vector<Index> vertex_of(full.vertex_count(), kNoIndex);
  for (Index c = 0; c < 3 * current.face_slot_count(); ++c) {
    if (!current.has_face(face_of_corner(c))) continue;
    const Index v = current.vertex(c);
    if (vertex_of[v] == kNoIndex) {
      vertex_of[v] = static_cast<Index>(level.positions.size());
      level.positions.push_back(full.positions[v]);
      level.wedge_vertex.push_back(vertex_of[v]);
    }
    level.corner_wedge.push_back(vertex_of[v]);
  }
  return level;
}

}  // namespace

DeviationBounds::DeviationBounds(const Mesh& full, double step)
    : full_(&full),
      step_(step),
      measured_faces_(full.face_count()),
      since_measured_(full.face_count()),
      since_start_(full.face_count()) {
  if (step > 0) level_.emplace(full, measuring_options());
  bound_.reserve(full.vertex_count());
}

void DeviationBounds::add(const RemovalRecord& record) {
  const double displacement = displacement_bound(*full_, record);
  for (Chain* chain : {&since_measured_, &since_start_}) chain->add(record, displacement);
  bound_.push_back(round_up(std::min(measured_ + since_measured_.largest, since_start_.largest)));
}

void DeviationBounds::Chain::add(const RemovalRecord& record, double displacement) {
  float before = 0;
  for (const SectorPatch& sector : record.sectors)
    for (const Index face : sector.faces) before = std::max(before, moved[face]);
  const float after = round_up(static_cast<double>(before) + displacement);
  for (const SectorPatch& sector : record.sectors)
    for (std::size_t i = 0; i < sector.triangles.size(); ++i) moved[sector.faces[i]] = after;
  largest = std::max(largest, static_cast<double>(after));
}

void DeviationBounds::end_round(const Connectivity& current) {
  const auto threshold = static_cast<double>(measured_faces_) * (1 - step_);
  if (!level_ || bound_.empty() || static_cast<double>(current.face_count()) > threshold) return;
  measured_ = level_->measure(current_level(*full_, current), since_measured_.largest).maximum_bound();
  measured_faces_ = current.face_count();
  since_measured_.reset();
  bound_.back() = round_up(std::min(static_cast<double>(bound_.back()), measured_));
}

}  // namespace lodestone::detail

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

}  // namespace

DeviationBounds::DeviationBounds(const Mesh& full) : full_(&full), moved_(full.face_count(), 0) {}

void DeviationBounds::add(const RemovalRecord& record) {
  float before = 0;
  for (const SectorPatch& sector : record.sectors)
    for (const Index face : sector.faces) before = std::max(before, moved_[face]);
  const float after = round_up(static_cast<double>(before) + displacement_bound(*full_, record));
  for (const SectorPatch& sector : record.sectors)
    for (std::size_t i = 0; i < sector.triangles.size(); ++i) moved_[sector.faces[i]] = after;
  largest_moved_ = std::max(largest_moved_, static_cast<double>(after));
  bound_.push_back(round_up(measured_ + largest_moved_));
}

void DeviationBounds::end_round(const Connectivity& current) { (void)current; }

}  // namespace lodestone::detail

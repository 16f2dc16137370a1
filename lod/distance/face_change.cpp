#include "distance/face_change.h"

#include "distance/round_up.h"

namespace lodestone::detail {
namespace {

constexpr Index kVanished = kNoIndex;

}  // namespace

void FaceChanges::add(const FaceChange& change) {
  entries_.push_back({static_cast<Index>(faces_.size()),
                      change.is_vanished ? kVanished : static_cast<Index>(change.fresh_count),
                      static_cast<Index>(change.gone.size()), change.moved});
  faces_.insert(faces_.end(), change.gone.begin(), change.gone.end());
  faces_.insert(faces_.end(), change.beside.begin(), change.beside.end());
}

FaceChange FaceChanges::add(const RemovalRecord& record, double displacement) {
  Entry entry{static_cast<Index>(faces_.size()), 0, 0, round_up(displacement)};
  const auto fresh_end = [](const SectorPatch& sector) {
    return sector.faces.begin() + static_cast<std::ptrdiff_t>(sector.triangles.size());
  };
  for (const SectorPatch& sector : record.sectors) {
    faces_.insert(faces_.end(), sector.faces.begin(), fresh_end(sector));
    entry.fresh += static_cast<Index>(sector.triangles.size());
    entry.gone += static_cast<Index>(sector.faces.size());
  }
  for (const SectorPatch& sector : record.sectors) faces_.insert(faces_.end(), fresh_end(sector), sector.faces.end());
  for (const SectorPatch& sector : record.sectors)
    if (sector.lone_outer != kNoIndex) faces_.push_back(face_of_corner(sector.lone_outer));
  entries_.push_back(entry);
  return (*this)[size() - 1];
}

FaceChange FaceChanges::add_vanished(std::span<const RemovalRecord> records, Index face, double reach) {
  Entry entry{static_cast<Index>(faces_.size()), kVanished, 0, round_up(reach)};
  for (const RemovalRecord& record : records)
    for (const SectorPatch& sector : record.sectors)
      faces_.insert(faces_.end(), sector.faces.begin(), sector.faces.end());
  entry.gone = static_cast<Index>(faces_.size()) - entry.first;
  faces_.push_back(face);
  entries_.push_back(entry);
  return (*this)[size() - 1];
}

void FaceChanges::clear() {
  entries_.clear();
  faces_.clear();
}

FaceChange FaceChanges::operator[](std::size_t i) const {
  const Entry& entry = entries_[i];
  const std::size_t end = i + 1 < size() ? entries_[i + 1].first : faces_.size();
  const std::span<const Index> faces(faces_.data() + entry.first, end - entry.first);
  const bool is_vanished = entry.fresh == kVanished;
  return {faces.first(entry.gone), is_vanished ? 0 : entry.fresh, faces.subspan(entry.gone), entry.moved, is_vanished};
}

void FaceReach::add(const FaceChange& change) {
  float before = 0;
  for (const Index face : change.gone) before = std::max(before, of[face]);
  const float after = round_up(static_cast<double>(before) + static_cast<double>(change.moved));
  for (const Index face : change.fresh()) of[face] = after;
  for (const Index face : change.beside) of[face] = std::max(of[face], after);
  largest = std::max(largest, after);
}

}  // namespace lodestone::detail

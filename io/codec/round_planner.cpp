#include "codec/round_planner.h"

#include <algorithm>

namespace lodestone::detail {
namespace {}  // namespace

CodedNumbers::CodedNumbers(const ProgressiveMesh& mesh)
    : vertex(mesh.positions.size(), kNoIndex), wedge(mesh.wedge_vertex.size(), kNoIndex) {
  for (const FaceGroup& group : mesh.groups) face.emplace_back(group.face_count, kNoIndex);
}

RoundPlanner::RoundPlanner(const ProgressiveMesh& mesh, const CodedNumbers& coded, const PatchMesh& level)
    : mesh_(mesh), coded_(coded), level_(level) {
  std::vector<Index> count;
  for (const FaceGroup& group : mesh.groups) {
    count.push_back(static_cast<Index>(group.base_corners.size() / 3));
    made_in_.emplace_back(group.face_count, 0);
  }
  for (const SectorHeader& sector : mesh.sectors) {
    first_slot_.push_back(count[sector.group]);
    count[sector.group] += static_cast<Index>(appended_face_count(sector.shape));
  }
}

/// Whether a record makes new pieces.
bool RoundPlanner::is_loose(Index record) const {
  const Index begin = mesh_.sector_begin[record], end = mesh_.sector_begin[record + 1];
  for (Index s = begin; s < end; ++s)
    if (mesh_.sectors[s].shape == SectorShape::Lone) return true;
  return begin == end;
}

/// Whether what a record needs was there before the round.
bool RoundPlanner::is_ready(Index record, Index round_first) const {
  for (Index s = mesh_.sector_begin[record]; s < mesh_.sector_begin[record + 1]; ++s) {
    for (const Index wedge : polygon(s))
      if (wedge >= mesh_.record_wedge_begin[round_first]) return false;
    for (const Index slot : slots(s))
      if (made_in_[mesh_.sectors[s].group][slot] == round_) return false;
  }
  return true;
}

void RoundPlanner::note_faces(Index record) {
  for (Index s = mesh_.sector_begin[record]; s < mesh_.sector_begin[record + 1]; ++s) {
    const auto count =
        static_cast<Index>(slots(s).size()) + static_cast<Index>(appended_face_count(mesh_.sectors[s].shape));
    for (Index i = 0; i < count; ++i) made_in_[mesh_.sectors[s].group][fine_slot(s, i)] = round_;
  }
}

Index RoundPlanner::take_round(Index first, Index last) {
  ++round_;
  Index record = first;
  for (; record < last && (is_loose(record) || is_ready(record, first)); ++record) note_faces(record);
  return record;
}

void RoundPlanner::plan(Index first, Index end, WorkListener& listener) {
  plan_.patch_of.assign(level_.face_count(), kNoIndex);
  plan_.is_ear.assign(3 * level_.face_count(), 0);
  plan_.closing_edge.clear();
  plan_.ear_count = 0;
  loose_.clear();
  fine_.clear();
  claim_.assign(3 * level_.face_count(), kNoIndex);
  ear_claim_.clear();
  has_borders_ = false;
  owner_.assign(level_.face_count(), 0);
  for (Index record = first; record < end && listener.step(); ++record)
    if (is_loose(record) || !plan_record(record)) loose_.push_back(record);
}

/// Finds the patches and ears of a record; false where it has others, too.
bool RoundPlanner::plan_record(Index record) {
  claims_.clear();
  ears_.clear();
  patches_.clear();
  faces_.clear();
  const Index begin = mesh_.sector_begin[record], end = mesh_.sector_begin[record + 1];
  for (Index s = begin; s < end; ++s)
    for (Index i = 0; i < slots(s).size(); ++i) {
      const Index face = coarse_face(s, i);
      if (face == kNoIndex || face >= level_.face_count()) return false;
      owner_[face] = record + 1;
      faces_.push_back(face);
    }
  bool is_planned = true;
  for (Index s = begin; s < end && is_planned; ++s) is_planned = slots(s).empty() || claim_sector(record, s);
  for (Index s = begin; s < end && is_planned; ++s) is_planned = !slots(s).empty() || claim_ear(record, s);
  std::size_t outer = 0;
  for (std::size_t i = 0; i < faces_.size() && is_planned; ++i)
    if (owner_[faces_[i]] == record + 1) {
      is_planned = plan_patch(record, faces_[i]);
      outer += ring_.size();
    }
  if (!is_planned || outer != claims_.size()) {
    for (const Index face : faces_) owner_[face] = 0;
    return false;
  }
  for (const PlannedPatch& patch : patches_) {
    for (const Index face : patch.faces) plan_.patch_of[face] = static_cast<Index>(plan_.closing_edge.size());
    plan_.closing_edge.push_back(patch.closing);
  }
  for (const Claim& claim : claims_) {
    claim_[claim.half] = static_cast<Index>(fine_.size());
    fine_.push_back(claim.face);
  }
  for (const Claim& ear : ears_) {
    plan_.is_ear[ear.half] = 1;
    ++plan_.ear_count;
    ear_claim_[ear.half] = static_cast<Index>(fine_.size());
    fine_.push_back(ear.face);
  }
  return true;
}

/// Finds the outer half-edges of a sector's coarse faces.
bool RoundPlanner::claim_sector(Index record, Index sector) {
  const std::span<const Index> ring = polygon(sector);
  const SectorShape shape = mesh_.sectors[sector].shape;
  const std::size_t size = ring.size();
  const std::size_t fine_count = size - 2 + static_cast<std::size_t>(appended_face_count(shape));
  std::size_t claimed = 0;
  for (Index i = 0; i + 2 < size; ++i) {
    const std::uint8_t* t = &mesh_.triangles[3 * (mesh_.slot_begin(sector) + i)];
    const Index face = coarse_face(sector, i);
    for (int k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      if (b != (a + 1) % size || a >= fine_count) continue;
      Index half = 3 * face;
      while (half < 3 * face + 3 && level_.wedge(half) != coded_.wedge[ring[a]]) ++half;
      if (half == 3 * face + 3 || level_.wedge(next_corner(half)) != coded_.wedge[ring[b]]) return false;
      claims_.push_back({half, {record, sector, a}});
      ++claimed;
    }
  }
  return claimed == fine_count;
}

/// Finds what a sector without coarse faces stands on: an edge of the record's other faces, or a border.
bool RoundPlanner::claim_ear(Index record, Index sector) {
  const std::span<const Index> ring = polygon(sector);
  const Index from = coded_.vertex[mesh_.wedge_vertex[ring[0]]], to = coded_.vertex[mesh_.wedge_vertex[ring[1]]];
  const FineFace fine = {record, sector, 0};
  for (const Index face : faces_)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index other = level_.twin(h);
      if (level_.from(h) != from || level_.to(h) != to || claim_of(h) != nullptr) continue;
      if (other != kNoIndex && owner_[face_of_corner(other)] == record + 1) continue;
      claims_.push_back({h, fine});
      return true;
    }
  const Index half = find_border(to, from, mesh_.sectors[sector].group, coded_.wedge[ring[1]], coded_.wedge[ring[0]]);
  if (half == kNoIndex) return false;
  for (const Claim& ear : ears_)
    if (ear.half == half) return false;
  ears_.push_back({half, fine});
  return true;
}

/// Returns a border half-edge between two vertices of the level before the round, one between these wedges if there is
/// one; kNoIndex if there is none, or it is taken.
Index RoundPlanner::find_border(Index from, Index to, Index group, Index from_wedge, Index to_wedge) {
  if (!has_borders_) {
    has_borders_ = true;
    borders_.clear();
    for (Index h = 0; h < 3 * level_.face_count(); ++h)
      if (level_.twin(h) == kNoIndex) borders_.emplace(ends_key(level_.from(h), level_.to(h)), h);
  }
  Index best = kNoIndex;
  int best_fit = -1;
  const auto [first, last] = borders_.equal_range(ends_key(from, to));
  for (auto it = first; it != last; ++it) {
    const Index half = it->second, face = face_of_corner(half);
    const bool closes = plan_.patch_of[face] != kNoIndex && plan_.closing_edge[plan_.patch_of[face]] == half;
    if (closes || plan_.is_ear[half] != 0) continue;
    const int fit = (level_.wedge(half) == from_wedge ? 1 : 0) + (level_.wedge(next_corner(half)) == to_wedge ? 1 : 0) +
                    (level_.group(face) == group ? 1 : 0);
    if (fit > best_fit || (fit == best_fit && half < best)) best = half, best_fit = fit;
  }
  return best;
}

const RoundPlanner::Claim* RoundPlanner::claim_of(Index half) const {
  const auto found = std::find_if(claims_.begin(), claims_.end(), [&](const Claim& c) { return c.half == half; });
  return found == claims_.end() ? nullptr : &*found;
}

/// Follows the outer edges of the faces that hang together with one and bear a stamp.
bool RoundPlanner::trace_ring(Index face, Index stamp) {
  const auto is_inner = [&](Index half) {
    const Index other = level_.twin(half);
    return other != kNoIndex && owner_[face_of_corner(other)] == stamp;
  };
  patches_.emplace_back();
  std::vector<Index>& faces = patches_.back().faces;
  faces.push_back(face);
  Index first = kNoIndex;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (Index h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
      if (!is_inner(h)) {
        first = h;
        continue;
      }
      const Index beyond = face_of_corner(level_.twin(h));
      if (std::find(faces.begin(), faces.end(), beyond) == faces.end()) faces.push_back(beyond);
    }
  ring_.clear();
  if (first == kNoIndex) return false;
  for (Index half = first;;) {
    ring_.push_back(half);
    if (ring_.size() > faces.size() + 2) return false;
    half = next_corner(half);
    for (std::size_t turns = 0; is_inner(half); ++turns) {
      if (turns > faces.size()) return false;
      half = next_corner(level_.twin(half));
    }
    if (half == first) break;
  }
  if (ring_.size() != faces.size() + 2 || ring_.size() > kMostPatchCorners) return false;
  for (std::size_t i = 0; i < ring_.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (level_.from(ring_[i]) == level_.from(ring_[j])) return false;
  return true;
}

/// Plans the patch that a face of a record lies in.
bool RoundPlanner::plan_patch(Index record, Index face) {
  if (!trace_ring(face, record + 1)) return false;
  PlannedPatch& patch = patches_.back();
  std::size_t closing = ring_.size();
  for (std::size_t i = 0; i < ring_.size(); ++i) {
    if (claim_of(ring_[i]) != nullptr) continue;
    if (closing < ring_.size() || level_.twin(ring_[i]) != kNoIndex || plan_.is_ear[ring_[i]] != 0) return false;
    closing = i;
  }
  for (const Claim& ear : ears_)
    if (closing < ring_.size() && ear.half == ring_[closing]) return false;
  const bool closed = closing == ring_.size();
  if (!closed) {
    patch.closing = ring_[closing];
    std::rotate(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(closing) + 1, ring_.end());
    ring_.pop_back();
  }
  if (!can_split(closed)) return false;
  for (const Index f : patch.faces) owner_[f] = kNoIndex;  // done
  return true;
}

/// Whether the star that takes the place of the faces inside the ring says what the record does.
bool RoundPlanner::can_split(bool closed) {
  star_.closed = closed;
  star_.faces.clear();
  star_.coarse.clear();
  for (const Index half : ring_) {
    const FineFace& fine = claim_of(half)->face;
    const std::span<const Index> wedges = polygon(fine.sector);
    const SectorHeader& sector = mesh_.sectors[fine.sector];
    star_.faces.push_back({0, sector.group, sector.wedge, coded_.wedge[wedges[fine.number]],
                           coded_.wedge[wedges[(fine.number + 1) % wedges.size()]]});
  }
  const auto place_of = [&](Index vertex) {
    Index k = 0;
    while (k < ring_.size() && level_.from(ring_[k]) != vertex) ++k;
    return k;
  };
  for (const Index face : patches_.back().faces) {
    Star::Coarse& coarse = star_.coarse.emplace_back();
    coarse.group = level_.group(face);
    for (Index k = 0; k < 3; ++k) {
      coarse.places[k] = place_of(level_.from(3 * face + k));
      coarse.wedges[k] = level_.wedge(3 * face + k);
    }
  }
  sectors_.clear();
  return split_star(star_, sectors_);
}

}  // namespace lodestone::detail

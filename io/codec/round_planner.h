#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <lodestone/lod/progressive_mesh.h>

#include "codec/level_coder.h"

namespace lodestone::detail {

/// What the numbers of a progressive mesh are in its stream, as far as they are coded.
struct CodedNumbers {
  explicit CodedNumbers(const ProgressiveMesh& mesh);

  std::vector<Index> vertex;             ///< by vertex of the mesh
  std::vector<Index> wedge;              ///< by wedge
  std::vector<std::vector<Index>> face;  ///< by group and slot: the level's face
};

/// Puts records together in rounds, and finds the patches and ears that they are in the level before.
class RoundPlanner {
 public:
  /// A face that a record makes.
  struct FineFace {
    Index record = 0;
    Index sector = 0;
    Index number = 0;  ///< in its sector
  };

  RoundPlanner(const ProgressiveMesh& mesh, const CodedNumbers& coded, const PatchMesh& level);

  /// Takes records, from one on and before another, while none needs what another of them makes; pieces that vanish are
  /// let pass. Returns the first of the next round.
  Index take_round(Index first, Index last);
  /// Plans a round. The listener hears of every record and may end it early.
  void plan(Index first, Index end, WorkListener& listener);

  const PatchPlan& patches() const { return plan_; }
  /// Records that are no patches and ears, in order.
  const std::vector<Index>& loose() const { return loose_; }
  /// What takes the place of an outer half-edge of a planned patch, or stands on the border half-edge of an ear.
  const FineFace& fine_face(Index half, bool is_ear) const {
    return fine_[is_ear ? ear_claim_.at(half) : claim_[half]];
  }

  std::span<const Index> polygon(Index sector) const {
    return std::span(mesh_.polygons).subspan(mesh_.polygon_begin[sector], mesh_.sectors[sector].polygon_size);
  }
  std::span<const Index> slots(Index sector) const {
    return std::span(mesh_.slots).subspan(mesh_.slot_begin(sector), mesh_.sectors[sector].polygon_size - 2U);
  }
  /// The slot of a fine face.
  Index fine_slot(Index sector, Index number) const {
    const std::span<const Index> kept = slots(sector);
    return number < kept.size() ? kept[number] : first_slot_[sector] + number - static_cast<Index>(kept.size());
  }
  Index coarse_face(Index sector, Index number) const {
    return coded_.face[mesh_.sectors[sector].group][slots(sector)[number]];
  }

 private:
  struct Claim {
    Index half;
    FineFace face;
  };
  bool is_loose(Index record) const;
  bool is_ready(Index record, Index round_first) const;
  void note_faces(Index record);
  bool plan_record(Index record);
  bool claim_sector(Index record, Index sector);
  bool claim_ear(Index record, Index sector);
  bool plan_patch(Index record, Index face);
  bool trace_ring(Index face, Index stamp);
  bool can_split(bool closed);
  const Claim* claim_of(Index half) const;
  Index find_border(Index from, Index to, Index group, Index from_wedge, Index to_wedge);

  const ProgressiveMesh& mesh_;
  const CodedNumbers& coded_;
  const PatchMesh& level_;
  std::vector<Index> first_slot_;            // by sector: of the faces it appends
  std::vector<std::vector<Index>> made_in_;  // by group and slot: the round that wrote it last
  Index round_ = 0;

  // Of the round at hand.
  PatchPlan plan_;
  std::vector<Index> loose_;
  std::vector<FineFace> fine_;
  std::vector<Index> claim_;                               // by half-edge: in `fine_`
  std::unordered_map<Index, Index> ear_claim_;             // the same of ears
  std::unordered_multimap<std::uint64_t, Index> borders_;  // half-edges by their ends
  bool has_borders_ = false;

  // Of the record at hand.
  std::vector<Index> owner_;  // by face of the level: the record that replaces it, plus 1; its patches once planned
  std::vector<Claim> claims_, ears_;
  std::vector<Index> faces_, ring_;
  struct PlannedPatch {
    std::vector<Index> faces;
    Index closing = kNoIndex;
  };
  std::vector<PlannedPatch> patches_;
  Star star_;
  SectorList sectors_;
};

}  // namespace lodestone::detail

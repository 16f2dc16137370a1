#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/number_coder.h"
#include "codec/patch_mesh.h"
#include "codec/star.h"
#include "codec/wedge_table.h"

namespace lodestone::detail {

/// Sectors that a loose record has at most, and corners of a sector's polygon.
inline constexpr std::size_t kMostLooseSectors = 1024;
inline constexpr std::size_t kMostPolygonCorners = 256;

/// A record that no patch and no ear tells: of a piece that comes into being, or where sheets meet in odd ways. It
/// names its faces and wedges.
struct LooseRecord {
  struct Sector {
    SectorShape shape = SectorShape::Open;
    Index group = 0;
    Index centre = 0;                ///< its number within the vertex
    std::vector<Index> coarse;       ///< faces that are replaced
    Index start = 0;                 ///< which of their outer edges the polygon begins with, in the order of the faces
    std::array<Index, 2> polygon{};  ///< its wedges where there are no coarse faces
  };
  std::vector<Sector> sectors;
};

/// Finds the polygon around some faces, by wedges, and the places of their corners in it; false where it is none.
bool trace_polygon(const PatchMesh& mesh, std::span<const Index> faces, Index start, std::vector<Index>& polygon,
                   std::vector<std::array<std::uint8_t, 3>>& triangles);

/// Codes loose records, and keeps the edges of their faces, to which those of later ones are joined.
class LooseCoder {
 public:
  explicit LooseCoder(Index group_count) : group_count_(group_count) {}

  /// Codes how many there are.
  Index code_count(BitCoder& coder, Index count);
  /// Codes a record of the last vertex and puts its faces there; its sectors are added, its new wedges too. At most
  /// `most_corners` polygon corners. False where what is read is no record.
  bool code(BitCoder& coder, LooseRecord& record, std::uint32_t round, std::uint64_t most_corners, PatchMesh& mesh,
            WedgeTable& wedges, SectorList& sectors);

 private:
  bool code_sector(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges, Index used,
                   LooseRecord::Sector& sector);
  bool add_sector(const LooseRecord::Sector& sector, const PatchMesh& mesh, const WedgeTable& wedges,
                  SectorList& sectors);
  bool place(std::size_t first_sector, std::uint32_t round, PatchMesh& mesh, const WedgeTable& wedges,
             SectorList& sectors);
  void join(std::span<const Index> fine, PatchMesh& mesh);
  std::int64_t code_number(BitCoder& coder, std::int64_t number, std::uint32_t kind);

  Index group_count_;
  BitMixer<1> bits_{{16}, 1};
  NumberCoder numbers_;
  std::unordered_map<std::uint64_t, Index> borders_;  // of loose faces, by their ends
  std::vector<Index> faces_, freed_;
};

}  // namespace lodestone::detail

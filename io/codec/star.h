#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/sector_shape.h>

namespace lodestone::detail {

/// Sectors of records, one after the other: what a progressive mesh has of them, by coded numbers.
struct SectorList {
  struct Sector {
    SectorShape shape = SectorShape::Open;
    Index group = 0;
    Index wedge = 0;        ///< the centre
    Index polygon_end = 0;  ///< in `polygons`; it begins where the one before ends
    Index coarse_end = 0;   ///< in `coarse` and `triangles`
    Index fine_end = 0;     ///< in `fine`
  };
  std::vector<Sector> sectors;
  std::vector<Index> polygons;                         ///< wedges
  std::vector<Index> coarse;                           ///< faces that are replaced
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< their corners' places in the polygon, ascending
  std::vector<Index> fine;                             ///< faces of the star, in order

  void clear();
  std::span<const Index> polygon(std::size_t sector) const;
  std::span<const Index> coarse_of(std::size_t sector) const;
  std::span<const std::array<std::uint8_t, 3>> triangles_of(std::size_t sector) const;
  std::span<const Index> fine_of(std::size_t sector) const;
  /// Adds a face that is replaced, by its corners' places in the polygon. False where they are no three.
  bool add_coarse(Index face, std::array<std::size_t, 3> places);
  /// Ends a sector: it has what has been added since the one before.
  void end_sector(SectorShape shape, Index group, Index wedge);
};

/// A star in place of a patch: what both sides of a record are, by one ring of corners.
struct Star {
  struct Spoke {
    Index face = 0;          ///< of the star: from this corner of the ring to the next
    Index group = 0;         ///< the face's
    Index centre = 0;        ///< its wedge at the vertex in the middle
    Index from = 0, to = 0;  ///< its wedges at the ring
  };
  struct Coarse {
    Index face = 0;
    Index group = 0;
    std::array<Index, 3> places{};  ///< corners of the ring
    std::array<Index, 3> wedges{};  ///< at those
  };
  bool closed = true;
  std::vector<Spoke> faces;
  std::vector<Coarse> coarse;  ///< two fewer than the ring has corners

  std::size_t ring_size() const { return faces.size() + (closed ? 0 : 1); }
};

/// Takes a star apart into the sectors of a record, which are added to `sectors`. False where records cannot say what
/// it does.
bool split_star(const Star& star, SectorList& sectors);

}  // namespace lodestone::detail

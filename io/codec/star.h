#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/sector_shape.h>

namespace lodestone::detail {

/// Of the corners of a sector's polygon.
inline constexpr std::size_t kMostPlaces = 256;

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

/// Whether faces of a closed star, at least one, differ in wedges or groups at a spoke. `spoke_at(i)` returns them.
template <class SpokeAt>
bool has_cut(std::size_t count, const SpokeAt& spoke_at) {
  const Star::Spoke last = spoke_at(count - 1);
  Index before = last.to;
  for (std::size_t i = 0; i < count; ++i) {
    const Star::Spoke& spoke = spoke_at(i);
    if (spoke.centre != last.centre || spoke.group != last.group || spoke.from != before) return true;
    before = spoke.to;
  }
  return false;
}

/// Adds the one sector of a closed star that has no cut, with all coarse faces: each has `face`, `group` and `wedges`,
/// at the corners `place_of(coarse, 0 … 2)` of the ring. False where those are not what the star is in place of. Most
/// stars are of this kind: they need not be put together for it.
template <class SpokeAt, class Coarse, class PlaceOf>
bool add_closed(std::size_t count, const SpokeAt& spoke_at, std::span<const Coarse> coarse, const PlaceOf& place_of,
                SectorList& sectors) {
  if (count != coarse.size() + 2 || count > kMostPlaces) return false;
  const std::size_t begin = sectors.polygons.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Star::Spoke& spoke = spoke_at(i);
    sectors.polygons.push_back(spoke.from);
    sectors.fine.push_back(spoke.face);
  }
  const Index group = spoke_at(0).group, centre = spoke_at(0).centre;
  for (const Coarse& triangle : coarse) {
    std::array<std::size_t, 3> places{};
    bool fits = triangle.group == group;
    for (std::size_t k = 0; k < 3; ++k) {
      places[k] = place_of(triangle, k);
      fits = fits && places[k] < count && sectors.polygons[begin + places[k]] == triangle.wedges[k];
    }
    if (!fits || !sectors.add_coarse(triangle.face, places)) return false;
  }
  sectors.end_sector(SectorShape::Closed, group, centre);
  return true;
}

/// Takes a star apart into the sectors of a record, which are added to `sectors`. False where records cannot say what
/// it does.
bool split_star(const Star& star, SectorList& sectors);

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>

#include "simplify/polygon_fills.h"
#include "simplify/removal_rules.h"

namespace lodestone::detail {

/// The star of a vertex with a closed ring and no constrained edge, as it is for most vertices: all that the ways to
/// fill its hole are judged by, in fixed arrays. Coordinates are relative to the vertex.
struct PlainStar {
  static constexpr std::size_t kMaxSize = kMaxSearchedPolygon;
  template <class T>
  using Ring = std::array<T, kMaxSize>;

  Index vertex = kNoIndex;
  Index wedge = kNoIndex;  ///< the vertex's one wedge here
  std::size_t size = 0;    ///< of the ring, and the number of faces
  Vec3 center;             ///< the vertex's place
  Ring<Index> corner;      ///< face i's corner at the vertex
  Ring<Index> ring_wedge;  ///< face i is (vertex, ring i, ring i + 1)
  Ring<Index> ring_vertex;
  Ring<Index> ring_site;          ///< the first of each ring vertex's copies
  std::uint64_t site_filter = 0;  ///< see may_be_on_ring
  Ring<Vec3> spoke;               ///< ring vertices
  Ring<Vec3> normal;              ///< of face i, twice its area long
  Ring<double> squared_normal;
  Ring<bool> has_direction;  ///< whether a face's normal is more than rounding
  FaceRules::Replaced faces;

  /// Looks at a vertex that is not one of several copies. False where its star is not plain, or too large: then nothing
  /// else is told.
  bool gather(const Mesh& mesh, const Connectivity& connectivity, const FaceRules& rules, Index of_vertex);

  /// False for most sites that are not on the ring.
  bool may_be_on_ring(Index site) const { return (site_filter >> (site % 64) & 1) != 0; }

  std::size_t after(std::size_t i) const { return i + 1 < size ? i + 1 : 0; }

 private:
  bool gather_ring(const Connectivity& connectivity);
  void gather_shapes(const Mesh& mesh, const FaceRules& rules);
};

/// Whether the ring passes one place once only, and no face lies over a star of three faces: else any filling doubles
/// an edge or a face.
bool is_simple(const PlainStar& star, const Connectivity& connectivity);

/// Returns which ring vertices an edge, in any sheet, joins to the one given: bit k stands for ring vertex k.
std::uint32_t linked_ring(const PlainStar& star, const Connectivity& connectivity, std::size_t to);

}  // namespace lodestone::detail

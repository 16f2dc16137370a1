#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone {

/// How much to fit, and what stays.
struct PlacementOptions {
  int iterations = 8;                 ///< of fitting, each moves all vertices; up to six times as many of small levels
  std::size_t samples_per_face = 60;  ///< at most, of the level's faces: where the original has more, some are left out
  /// One per vertex of the original, or empty: where it is not 0, what lies there stays, bit for bit, and so do the
  /// edges of faces between such vertices.
  std::vector<std::uint8_t> fixed;
};

/// Moves the vertices of a level to where its faces fit the original best, and turns edges where that fits better.
///
/// Fits by least squares to points of the original, its borders and other constrained lines (seams, material borders)
/// to points of its lines; fine levels, which share faces with the original, by least sums of distances. Faces neither
/// turn over nor degenerate, and none reaches out of the original's box by more than
/// the surface around it was off; vertices, wedges and materials stay, and so do the wedges of lines. Attributes are
/// looked up where a vertex has gone to, on its own side of every seam: they are blended from the original's there, but
/// joints and weights, which stay those of the vertex.
///
/// Pre: `level` comes from `original` by removals. Deterministic. Cost: some queries for each of the original's points.
Mesh optimise_placement(const Mesh& original, const Mesh& level, const PlacementOptions& options = {});

}  // namespace lodestone

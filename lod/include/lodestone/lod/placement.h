#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <lodestone/core/effort.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>

namespace lodestone {

/// How much to fit, and what stays.
struct PlacementOptions {
  int effort = kDefaultEffort;  ///< how often vertices move, and by how many points of the original: see core/effort.h
  /// One per vertex of the original, or empty: where it is not 0, what lies there stays, bit for bit, and so do the
  /// edges of faces between such vertices.
  std::vector<std::uint8_t> fixed;
  Progress progress;  ///< cancelled, fitting ends with the level as it was given
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

/// The same for several levels of one mesh: makes what all of them need once. Levels may be fitted side by side.
class LevelFitter {
 public:
  /// `original` outlives it. Where `progress`, which hears and tells nothing, is cancelled, levels stay as they are
  /// given. Cost: O(n log n).
  explicit LevelFitter(const Mesh& original, const Progress& progress = {});
  ~LevelFitter();
  LevelFitter(LevelFitter&&) noexcept;
  LevelFitter& operator=(LevelFitter&&) noexcept;

  /// Returns what optimise_placement returns for the level.
  Mesh fit(const Mesh& level, const PlacementOptions& options = {}) const;

  /// Where the vertices of a level go.
  struct Places {
    std::vector<Vec3f> positions;  ///< by vertex of the level
    double rms = 0;                ///< distance of the original's points from the level then, mesh units
  };
  /// Moves the vertices of a level only, most of all along their normals; its faces and attributes stay as they are.
  Places find_places(const Mesh& level, const PlacementOptions& options = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone

#pragma once

#include <cstddef>
#include <memory>

#include "surface.h"

namespace lodestone::bench {

/// Distances from samples of one surface to the nearest points of another, mesh units.
struct OneWay {
  double mean = 0;
  double rms = 0;
  double maximum = 0;       ///< of the samples
  double normal_angle = 0;  ///< degrees, mean over the first surface's area
};

/// What the referee says of one simplified surface. Distances are in % of the original's diagonal.
struct Judgement {
  std::size_t faces = 0;
  double mean = 0;                    ///< mean of both directions
  double rms = 0;                     ///< mean of both directions
  double maximum = 0;                 ///< largest of both directions
  double normal_angle = 0;            ///< degrees, over the original's area
  double minimum_angle = 0;           ///< degrees, mean of the faces' smallest angles
  std::size_t nonmanifold_edges = 0;  ///< edges of more than two faces, beyond the original's count
  std::size_t flipped_faces = 0;      ///< faces that look away from the original all over, where it is nearest
  std::size_t sliver_faces = 0;       ///< faces with an angle under 1°, beyond the original's count
};

/// Measures surfaces against an original, with nothing of lodestone's own measures: CGAL's AABB tree finds the nearest
/// points, samples lie as the Metro tool's (Cignoni, Rocchini, Scopigno, 1998) do by default. Deterministic.
class Referee {
 public:
  /// `samples`: about as many are taken each way at most; weights stay Metro's whatever the number. Pre: some faces.
  Referee(Surface original, std::size_t samples);
  ~Referee();
  Referee(Referee&&) noexcept;

  Judgement judge(const Surface& simplified) const;
  OneWay forward(const Surface& simplified) const;   ///< from the original to `simplified`
  OneWay backward(const Surface& simplified) const;  ///< from `simplified` to the original

  struct Impl;  ///< opaque

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone::bench

#pragma once

#include <array>
#include <cstddef>

#include <lodestone/core/effort.h>
#include <lodestone/io/compact_stream.h>

namespace lodestone::detail {

/// What a build's own steps do at one effort; simplifying and fitting have tables of their own. Bounds are proved at
/// each, and means of samples have no bias: with less work bounds are less tight, and means less sure.
struct BuildEffort {
  double measure_step;            ///< how much of the faces goes between two measurements of what bounds are
  double tolerance;               ///< of a level's maximum: its bound is above what was found by this share at most
  std::size_t distance_samples;   ///< each way, for a level of all meshes together
  std::size_t attribute_samples;  ///< likewise; largest differences stand at few places, so that they need more
  int probe_count;                ///< positions beyond bounds at which levels by error are fitted and measured
  CompactCoding stream_coding;    ///< where the options leave it open
};

/// From the default on there are two digits for a table and a report, in a fraction of the time that `compare` takes
/// for its four.
inline constexpr std::array<BuildEffort, kMostEffort> kBuildEfforts = {
    {{0.75, 0.1, 4'000, 4'000, 0, CompactCoding::Fast},
     {0.5, 0.05, 8'000, 12'000, 0, CompactCoding::Fast},
     {0.2, 0.03, 12'000, 24'000, 0, CompactCoding::Small},
     {0.2, 0.02, 16'000, 32'000, 0, CompactCoding::Small},
     {0.1, 0.01, 20'000, 40'000, 0, CompactCoding::Small},
     {0.1, 0.01, 20'000, 40'000, 0, CompactCoding::Small},
     {0.1, 0.01, 20'000, 40'000, 2, CompactCoding::Small},
     {0.1, 0.01, 20'000, 40'000, 4, CompactCoding::Small},
     {0.1, 0.01, 20'000, 40'000, 4, CompactCoding::Small}}};

/// Pre: the effort is one there is.
constexpr const BuildEffort& build_effort(int effort) {
  return kBuildEfforts[static_cast<std::size_t>(effort - kLeastEffort)];
}

}  // namespace lodestone::detail

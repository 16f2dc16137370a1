// The cost of a removal joins three measures of what it changes:
//   V  the volume swept between the old faces and the new ones, memoryless, after Lindstrom, Turk: Fast and memory
//      efficient polygonal simplification (Visualization 1998);
//   D  the distance of everything removed so far to the surface that now stands for it, less most of what it was before
//      the removal: the memory keeps the total honest, the difference lets what is lost already be;
//   ΔK the change of the discrete curvature against the full mesh, after Kim, Hong, Kim.
// The pure metrics of Kim, Hong, Kim use the last alone. bench/README.md has the trials behind the constants.

#include "simplify/removal_cost.h"

#include <algorithm>
#include <cmath>

namespace lodestone::detail {
namespace {

// Triangulations, by swept volume, whose distances are measured, from which effort on.
constexpr int kMeasuresDistances = 3;
constexpr int kMeasuresSome = 5;
constexpr int kMeasuresMore = 8;
constexpr std::size_t kSome = 3;
constexpr double kForgiven = 0.7;            // share of the distances before that a removal is not charged for
constexpr double kLeastCharged = 0.02;       // share of the distances after it that it is charged for in any case
constexpr double kMinCurvatureChange = 0.2;  // radians; below it curvature does not separate removals

}  // namespace

double charged_distance(double after, double before) {
  return std::max(after - kForgiven * before, kLeastCharged * after);
}

double hybrid_cost(double moved, double turned) {
  return std::pow(moved, kDistanceExponent) * std::pow(std::max(turned, kMinCurvatureChange), 1 - kDistanceExponent);
}

double hybrid_cost(const Displacement& moved, bool measures_distances, double turned) {
  const double volume = std::cbrt(std::sqrt(moved.squared_volume));
  const double swept = measures_distances ? std::sqrt(volume * std::sqrt(moved.squared_distance)) : volume;
  return hybrid_cost(swept + moved.line + std::sqrt(moved.squared_attributes), turned);
}

std::size_t measured_triangulations(const SimplifyOptions& options) {
  if (options.metric != Metric::Hybrid) return 0;
  if (options.effort >= kMeasuresMore) return kMostMeasured;
  if (options.effort >= kMeasuresSome) return kSome;
  return options.effort >= kMeasuresDistances ? 1 : 0;
}

}  // namespace lodestone::detail

#include <lodestone/lod/place_levels.h>

#include <algorithm>
#include <utility>

#include <lodestone/lod/cursor.h>

namespace lodestone {
namespace {

constexpr double kRatio = 4;           // between levels, of vertices
constexpr double kCoarsest = 0.01;     // share of the vertices
constexpr Index kFewestVertices = 16;  // of a level, and more than the base mesh has
constexpr double kPrecision = 3;       // of the rms distance: rounded by that much, a level is a tenth worse at most
constexpr double kTolerance = 0.02;    // of bounds
constexpr double kFitShare = 0.7;      // of the work

/// The positions to fit, fine to coarse; none that has a part of a piece.
std::vector<Index> positions_of_levels(const ProgressiveMesh& mesh) {
  std::vector<Index> positions;
  const auto whole = static_cast<double>(mesh.vertex_count());
  for (double share = 1 / kRatio; share >= kCoarsest; share /= kRatio) {
    const auto vertices = static_cast<Index>(share * whole);
    if (vertices < kFewestVertices || vertices <= mesh.base_vertex_count) break;
    Index position = vertices - mesh.base_vertex_count;
    while (position > 0 && !is_whole(mesh, position)) --position;
    if (position > 0 && (positions.empty() || position < positions.back())) positions.push_back(position);
  }
  return positions;
}

}  // namespace

std::vector<PlacedLevel> place_levels(const LevelFitter& fitter, const MeasuredSurface& original,
                                      const ProgressiveMesh& mesh, const PlacementOptions& options) {
  std::vector<PlacedLevel> levels;
  const bool has_fixed =
      std::any_of(options.fixed.begin(), options.fixed.end(), [](std::uint8_t fixed) { return fixed != 0; });
  const std::vector<Index> positions = positions_of_levels(mesh);
  for (const Index position : positions) {
    const Progress work = options.progress.part(1 / static_cast<double>(positions.size()));
    PlacementOptions placement = options;
    placement.progress = work.part(kFitShare);
    Mesh level = extract_level(mesh, position);
    LevelFitter::Places places = fitter.find_places(level, placement);
    if (options.progress.is_cancelled()) return {};
    level.positions = places.positions;
    DeviationOptions measuring;
    measuring.relative_tolerance = kTolerance;
    measuring.progress = work.part(1 - kFitShare);
    const double bound = measure_maximum(MeasuredSurface(level), original, measuring).maximum_bound();
    if (options.progress.is_cancelled()) return {};
    levels.push_back({position, std::move(places.positions), static_cast<float>(bound),
                      has_fixed ? 0 : static_cast<float>(kPrecision * places.rms)});
  }
  std::reverse(levels.begin(), levels.end());
  return levels;
}

}  // namespace lodestone

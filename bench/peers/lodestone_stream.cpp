#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>

#include <lodestone/lod/cursor.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>

#include "lodestone_stream.h"
#include "simplifier.h"

namespace lodestone::bench {
namespace {

// Bounds on each record are no part of what peers do, and change no removal.
SimplifyOptions options_without_bounds(int effort) {
  SimplifyOptions options;
  options.effort = effort;
  options.measure_step = 0;
  return options;
}

/// Simplifies to the base mesh once and takes every level out of the stream, fitted to the original or as it is: each
/// has the time of the whole, and of its own fitting.
std::vector<Level> levels_of(const Mesh& mesh, std::span<const std::size_t> face_counts, SimplifyOptions options,
                             bool fitted) {
  const Clock clock;
  const Result<SimplifyResult> simplified = simplify(mesh, options);
  const Seconds simplify_seconds = clock.seconds();
  if (!simplified) {
    std::fprintf(stderr, "lodestone: %s\n", simplified.error().message.c_str());
    std::exit(1);
  }
  const Clock preparing;
  std::optional<LevelFitter> fitter;
  if (fitted) fitter.emplace(mesh);
  const Seconds prepare_seconds = preparing.seconds();
  PlacementOptions placement;
  placement.effort = options.effort;
  std::vector<Level> levels;
  Cursor cursor(simplified->mesh);
  for (const std::size_t faces : face_counts) {
    cursor.seek(position_for_faces(simplified->mesh, faces));
    Seconds seconds = simplify_seconds + prepare_seconds;
    const Clock fitting;
    Mesh level = extract_level(simplified->mesh, cursor);
    if (fitted) {
      level = fitter->fit(level, placement);
      seconds = seconds + fitting.seconds();
    }
    levels.push_back({surface_of(level), seconds});
  }
  return levels;
}

}  // namespace

std::vector<Level> run_lodestone_levels(const Mesh& mesh, std::span<const std::size_t> face_counts, int effort) {
  return levels_of(mesh, face_counts, options_without_bounds(effort), true);
}

std::vector<Level> run_lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts, int effort) {
  return lodestone_stream(mesh, face_counts, options_without_bounds(effort));
}

std::vector<Level> lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts,
                                    SimplifyOptions options) {
  return levels_of(mesh, face_counts, std::move(options), false);
}

}  // namespace lodestone::bench

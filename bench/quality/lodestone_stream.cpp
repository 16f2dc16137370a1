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

/// Simplifies to the base mesh once and takes every level out of the stream, fitted to the original or as it is: each
/// has the CPU time of the whole, and of its own fitting.
std::vector<Level> levels_of(const Mesh& mesh, std::span<const std::size_t> face_counts, SimplifyOptions options,
                             bool fitted) {
  options.measure_step = 0;  // Bounds on each record are no part of what peers do, and change no removal.
  const CpuClock clock;
  const Result<SimplifyResult> simplified = simplify(mesh, options);
  const double simplify_seconds = clock.seconds();
  if (!simplified) {
    std::fprintf(stderr, "lodestone: %s\n", simplified.error().message.c_str());
    std::exit(1);
  }
  const CpuClock preparing;
  std::optional<LevelFitter> fitter;
  if (fitted) fitter.emplace(mesh);
  const double prepare_seconds = fitted ? preparing.seconds() : 0;
  PlacementOptions placement;
  placement.effort = options.effort;
  std::vector<Level> levels;
  Cursor cursor(simplified->mesh);
  for (const std::size_t faces : face_counts) {
    cursor.seek(position_for_faces(simplified->mesh, faces));
    const CpuClock fitting;
    Mesh level = extract_level(simplified->mesh, cursor);
    if (fitted) level = fitter->fit(level, placement);
    levels.push_back({surface_of(level), simplify_seconds + prepare_seconds + (fitted ? fitting.seconds() : 0)});
  }
  return levels;
}

}  // namespace

std::vector<Level> run_lodestone_levels(const Mesh& mesh, std::span<const std::size_t> face_counts, int effort) {
  SimplifyOptions options;
  options.effort = effort;
  return levels_of(mesh, face_counts, std::move(options), true);
}

std::vector<Level> run_lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts, int effort) {
  SimplifyOptions options;
  options.effort = effort;
  return lodestone_stream(mesh, face_counts, std::move(options));
}

std::vector<Level> lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts,
                                    SimplifyOptions options) {
  return levels_of(mesh, face_counts, std::move(options), false);
}

}  // namespace lodestone::bench

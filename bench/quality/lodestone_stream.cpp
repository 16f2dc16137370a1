#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <lodestone/lod/cursor.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>

#include "lodestone_stream.h"
#include "simplifier.h"

namespace lodestone::bench {

std::vector<Level> run_lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  return lodestone_stream(mesh, face_counts, {});
}

std::vector<Level> run_lodestone_levels(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  SimplifyOptions options;
  options.measure_step = 0;
  const CpuClock clock;
  const Result<SimplifyResult> simplified = simplify(mesh, options);
  const double simplify_seconds = clock.seconds();
  if (!simplified) {
    std::fprintf(stderr, "lodestone: %s\n", simplified.error().message.c_str());
    std::exit(1);
  }
  std::vector<Level> levels;
  Cursor cursor(simplified->mesh);
  for (const std::size_t faces : face_counts) {
    cursor.seek(position_for_faces(simplified->mesh, faces));
    const CpuClock fitting;
    const Mesh fitted = optimise_placement(mesh, extract_level(simplified->mesh, cursor));
    levels.push_back({surface_of(fitted), simplify_seconds + fitting.seconds()});
  }
  return levels;
}

std::vector<Level> lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts,
                                    SimplifyOptions options) {
  options.measure_step = 0;  // Bounds on each record are no part of what peers do, and change no removal.
  const CpuClock clock;
  const Result<SimplifyResult> simplified = simplify(mesh, options);
  const double cpu_seconds = clock.seconds();
  if (!simplified) {
    std::fprintf(stderr, "lodestone: %s\n", simplified.error().message.c_str());
    std::exit(1);
  }
  std::vector<Level> levels;
  Cursor cursor(simplified->mesh);
  for (const std::size_t faces : face_counts) {
    cursor.seek(position_for_faces(simplified->mesh, faces));
    levels.push_back({surface_of(extract_level(simplified->mesh, cursor)), cpu_seconds});
  }
  return levels;
}

}  // namespace lodestone::bench

// What time goes into, each by itself: google-benchmark's options choose among them.

#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/lod/surface_index.h>

#include "displaced_torus.h"
#include "distance/point_triangle.h"
#include "distance/surface_walk.h"

namespace lodestone::bench {
namespace {

constexpr std::size_t kFaces = 20'000;
constexpr std::size_t kLevelFaces = kFaces / 10;

const Mesh& torus() {
  static const Mesh mesh = assemble(displaced_torus(kFaces))->mesh;
  return mesh;
}

SimplifyResult simplified(double measure_step) {
  SimplifyOptions options;
  options.measure_step = measure_step;
  return *simplify(torus(), options);
}

const Mesh& level() {
  static const Mesh mesh = [] {
    const ProgressiveMesh progressive = simplified(0).mesh;
    return extract_level(progressive, position_for_faces(progressive, kLevelFaces));
  }();
  return mesh;
}

/// A point of the torus for each of its faces: near the level, and not on it.
std::vector<Vec3> points_near_level() {
  std::vector<Vec3> points;
  for (Index face = 0; face < torus().face_count(); ++face) points.push_back(point_on_face(torus(), face, 0));
  return points;
}

void count(benchmark::State& state, const char* what, std::size_t each) {
  state.counters[what] = benchmark::Counter(static_cast<double>(each) * static_cast<double>(state.iterations()),
                                            benchmark::Counter::kIsRate);
}

void squared_distances(benchmark::State& state) {
  const auto size = static_cast<std::size_t>(state.range(0));
  const std::vector<Vec3> near = points_near_level();
  detail::PointBatch points;
  for (std::size_t i = 0; i < size; ++i) points.add(near[i]);
  const std::array<Vec3, 3> triangle = {torus().corner_position(0), torus().corner_position(1),
                                        torus().corner_position(2)};
  std::vector<float> distances(points.padded_size());
  for (auto _ : state) {
    detail::squared_distances(points, triangle, distances.data());
    benchmark::DoNotOptimize(distances.data());
    benchmark::ClobberMemory();
  }
  count(state, "points", size);
}
BENCHMARK(squared_distances)->Arg(8)->Arg(32)->Arg(128);

void surface_index(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(SurfaceIndex(torus()));
  count(state, "faces", torus().face_count());
}
BENCHMARK(surface_index)->Unit(benchmark::kMillisecond);

/// Searches from the root.
void nearest(benchmark::State& state) {
  const SurfaceIndex index(level());
  const std::vector<Vec3> points = points_near_level();
  for (auto _ : state) {
    for (const Vec3& p : points)
      benchmark::DoNotOptimize(index.nearest(p, std::numeric_limits<double>::infinity()).distance);
  }
  count(state, "points", points.size());
}
BENCHMARK(nearest)->Unit(benchmark::kMillisecond);

/// Walks from the face that was nearest.
void nearest_from(benchmark::State& state) {
  const SurfaceIndex index(level());
  const detail::SurfaceWalk walk(level());
  const std::vector<Vec3> points = points_near_level();
  std::vector<Index> faces;
  for (const Vec3& p : points) faces.push_back(index.nearest(p, std::numeric_limits<double>::infinity()).face);
  for (auto _ : state) {
    for (std::size_t i = 0; i < points.size(); ++i)
      benchmark::DoNotOptimize(walk.nearest_from(points[i], faces[i]).on.squared_distance);
  }
  count(state, "points", points.size());
}
BENCHMARK(nearest_from)->Unit(benchmark::kMillisecond);

/// To the base mesh; an evaluation looks at one vertex and its star.
void simplify_to_base(benchmark::State& state, double measure_step) {
  std::size_t evaluations = 0;
  std::size_t records = 0;
  for (auto _ : state) {
    const SimplifyResult result = simplified(measure_step);
    evaluations = result.evaluation_count;
    records = result.mesh.record_count();
  }
  count(state, "evaluations", evaluations);
  count(state, "faces", torus().face_count());
  state.counters["evaluations_per_removal"] = static_cast<double>(evaluations) / static_cast<double>(records);
}
BENCHMARK_CAPTURE(simplify_to_base, without_bounds, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simplify_to_base, with_bounds, SimplifyOptions().measure_step)->Unit(benchmark::kMillisecond);

void level_fitter(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(LevelFitter(torus()));
  count(state, "faces", torus().face_count());
}
BENCHMARK(level_fitter)->Unit(benchmark::kMillisecond);

void fit(benchmark::State& state) {
  const LevelFitter fitter(torus());
  for (auto _ : state) benchmark::DoNotOptimize(fitter.fit(level()).face_count());
  count(state, "faces", torus().face_count());
}
BENCHMARK(fit)->Unit(benchmark::kMillisecond);

void measure(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(measure_deviation(torus(), level()).maximum());
}
BENCHMARK(measure)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lodestone::bench

BENCHMARK_MAIN();

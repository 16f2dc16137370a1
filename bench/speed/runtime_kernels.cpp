// What drawing from records costs that are there: records a second that a cursor passes, to the finest level and back,
// with the changes taken as an engine does that uploads them.

#include <benchmark/benchmark.h>

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "displaced_torus.h"
#include "mesh_files.h"

namespace lodestone::bench {
namespace {

constexpr Index kSteps = 64;     // that it takes to the finest level, and back
constexpr std::size_t kGap = 8;  // entries between ranges that are uploaded as one

/// A torus of about so many faces with normals and texture coordinates, down to its base mesh.
const ProgressiveMesh& records(std::size_t faces) {
  static std::map<std::size_t, ProgressiveMesh> made;
  const auto found = made.find(faces);
  if (found != made.end()) return found->second;
  SimplifyOptions options;
  options.measure_step = 0;
  options.effort = 1;
  options.dense_rounds = 1.5;  // as streams have them
  return made.emplace(faces, simplify(with_attributes(assemble(displaced_torus(faces))->mesh), options)->mesh)
      .first->second;
}

template <class Cursor, class Visit>
void there_and_back(benchmark::State& state, const ProgressiveMesh& mesh, Cursor& cursor, const Visit& visit) {
  const std::size_t count = mesh.record_count();
  const auto seek = [&](std::size_t step) {
    cursor.seek(static_cast<Index>(count * step / kSteps));
    visit();
  };
  for (auto _ : state) {
    for (std::size_t step = 0; step <= kSteps; ++step) seek(step);
    for (std::size_t step = kSteps; step-- > 0;) seek(step);
  }
  state.counters["records"] = benchmark::Counter(
      2 * static_cast<double>(count) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["vertices"] = static_cast<double>(mesh.vertex_count());
}

void cursor_there_and_back(benchmark::State& state) {
  const ProgressiveMesh& mesh = records(static_cast<std::size_t>(state.range(0)));
  Cursor cursor(mesh);
  there_and_back(state, mesh, cursor, [] {});
}
BENCHMARK(cursor_there_and_back)->Arg(20'000)->Arg(200'000)->Arg(4'000'000)->Unit(benchmark::kMillisecond);

void draw_cursor_there_and_back(benchmark::State& state) {
  const ProgressiveMesh& mesh = records(static_cast<std::size_t>(state.range(0)));
  DrawCursor cursor(mesh);
  std::vector<EntryRange> ranges;
  there_and_back(state, mesh, cursor, [&] {
    for (std::size_t group = 0; group < cursor.group_count(); ++group) cursor.take_changes(group, kGap, ranges);
    benchmark::DoNotOptimize(cursor.take_new_wedges());
    benchmark::DoNotOptimize(ranges.data());
  });
}
BENCHMARK(draw_cursor_there_and_back)->Arg(20'000)->Arg(200'000)->Arg(4'000'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lodestone::bench

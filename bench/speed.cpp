// How fast a mesh is taken down to its base mesh, and with how much memory.
//
//   speed [google-benchmark's options] [FILE …]
//
// Without files: the paper's models where they lie beside the repository, and the demo's model.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "peak_memory.h"

namespace lodestone::bench {
namespace {

namespace fs = std::filesystem;

/// Runs once, outside the timing, for the numbers that are the same every time.
void report_counts(benchmark::State& state, const Mesh& mesh) {
  const PeakMemory memory;
  const Result<SimplifyResult> result = simplify(mesh);
  const auto peak_bytes = memory.bytes();
  if (!result) return state.SkipWithError(result.error().message.c_str());

  const auto faces = static_cast<double>(mesh.face_count());
  const auto removals = static_cast<double>(result->mesh.record_count());
  state.counters["faces"] = faces;
  state.counters["base_faces"] = static_cast<double>(Cursor(result->mesh).face_count());
  state.counters["evaluations_per_removal"] = static_cast<double>(result->evaluation_count) / removals;
  if (peak_bytes) state.counters["peak_bytes_per_face"] = static_cast<double>(*peak_bytes) / faces;
}

void simplify_to_base(benchmark::State& state, const Mesh& mesh) {
  report_counts(state, mesh);
  for (auto _ : state) benchmark::DoNotOptimize(simplify(mesh));
  state.counters["faces_per_second"] = benchmark::Counter(
      static_cast<double>(mesh.face_count()) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

std::vector<fs::path> default_files() {
  const fs::path source = LODESTONE_SOURCE_DIR;
  std::vector<fs::path> files;
  for (const char* name :
       {"../shared/data/paper/stanford-bunny.obj", "../shared/data/paper/fandisk.obj", "demo/suzi.glb"}) {
    if (fs::exists(source / name)) files.push_back(source / name);
  }
  return files;
}

/// Returns false where the file cannot be read; says why on standard error.
bool register_file(const fs::path& path) {
  Result<MeshFile> file = read_mesh(path);
  if (!file) {
    std::fprintf(stderr, "%s: %s\n", path.c_str(), file.error().message.c_str());
    return false;
  }
  const std::string name = "simplify/" + path.filename().string();
  benchmark::RegisterBenchmark(name.c_str(), [mesh = std::move(file->mesh)](benchmark::State& state) {
    simplify_to_base(state, mesh);
  })->Unit(benchmark::kMillisecond);
  return true;
}

}  // namespace
}  // namespace lodestone::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  std::vector<std::filesystem::path> files(argv + 1, argv + argc);
  if (files.empty()) files = lodestone::bench::default_files();
  for (const auto& file : files) {
    if (!lodestone::bench::register_file(file)) return 1;
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

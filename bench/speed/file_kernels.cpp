// What reading and writing files takes: bytes a second, by one thread and by two. "parse" is a format's reader alone,
// "read" is what programs call, with the mesh assembled; files lie in memory.

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/parallel.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/write_mesh.h>

#include "base/files_beside.h"
#include "displaced_torus.h"
#include "gltf/gltf_flatten.h"
#include "mesh/soup_file.h"
#include "mesh_files.h"

namespace lodestone::bench {
namespace {

constexpr std::size_t kFaces = 500'000;

/// With normals and texture coordinates, or bare.
const Mesh& mesh(bool attributes) {
  static const Mesh bare = assemble(displaced_torus(kFaces))->mesh;
  static const Mesh full = with_attributes(bare);
  return attributes ? full : bare;
}

const std::vector<std::byte>& file(const std::string& format, bool attributes) {
  static std::map<std::pair<std::string, bool>, std::vector<std::byte>> files;
  std::vector<std::byte>& bytes = files[{format, attributes}];
  if (bytes.empty()) bytes = file_bytes(mesh(attributes), format);
  return bytes;
}

std::string extension(const std::string& format) { return format.substr(0, format.find('-')); }

Result<detail::SoupFile> parsed(std::span<const std::byte> bytes, const std::string& extension) {
  if (extension == "obj") return detail::read_obj(bytes, detail::nothing_beside);
  if (extension == "off") return detail::read_off(bytes);
  if (extension == "ply") return detail::read_ply(bytes, detail::nothing_beside);
  if (extension == "stl") return detail::read_stl(bytes);
  return detail::read_gltf(bytes, detail::nothing_beside);
}

/// Runs `work`, which takes or makes so many bytes, by as many threads as the benchmark's argument says.
template <class Work>
void measure_bytes(benchmark::State& state, std::size_t bytes, const Work& work) {
  with_threads(static_cast<std::size_t>(state.range(0)), [&] {
    for (auto _ : state) work();
  });
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes) * static_cast<std::int64_t>(state.iterations()));
}

void parse(benchmark::State& state, const std::string& format, bool attributes) {
  const std::vector<std::byte>& bytes = file(format, attributes);
  measure_bytes(state, bytes.size(), [&] {
    if (parsed(bytes, extension(format))->soup.indices.empty()) state.SkipWithError("nothing was read");
  });
}

void read(benchmark::State& state, const std::string& format, bool attributes) {
  const std::vector<std::byte>& bytes = file(format, attributes);
  measure_bytes(state, bytes.size(), [&] {
    if (read_mesh_bytes(bytes, extension(format))->mesh.corner_wedge.empty()) state.SkipWithError("nothing was read");
  });
}

void write(benchmark::State& state, const std::string& format, bool attributes) {
  measure_bytes(state, file(format, attributes).size(),
                [&] { benchmark::DoNotOptimize(write_mesh_bytes(mesh(attributes), "mesh." + format)->data()); });
}

void add(const char* job, const std::string& format, bool attributes,
         void (*run)(benchmark::State&, const std::string&, bool)) {
  const std::string name = std::string(job) + "/" + format + (attributes ? "/attributes" : "");
  benchmark::RegisterBenchmark(name.c_str(), run, format, attributes)
      ->Arg(1)
      ->Arg(2)
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMillisecond);
}

const bool kRegistered = [] {
  for (const bool attributes : {false, true}) {
    for (const char* format : {"obj", "ply", "glb"}) {
      add("parse", format, attributes, parse);
      add("read", format, attributes, read);
      add("write", format, attributes, write);
    }
  }
  for (const char* format : {"ply-ascii", "off", "stl", "stl-ascii"}) {
    add("parse", format, false, parse);
    add("read", format, false, read);
  }
  return true;
}();

}  // namespace
}  // namespace lodestone::bench

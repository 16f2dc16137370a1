// Bits for each vertex of compact streams, by part, beside Draco on the same grid; positions alone. The whole of either
// file counts. Streams are decoded again, so that the times of both ways are there, and checked.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "gltf/draco_encode.h"

namespace lodestone::bench {
namespace {

struct Options {
  std::string data = "../shared/data";
  std::vector<std::string> files = {"paper/stanford-bunny.obj", "paper/fandisk.obj", "mesh/rocker-arm.obj",
                                    "mesh/homer.obj",           "mesh/cow.obj",      "mesh/cheburashka.obj"};
  std::vector<int> bits = {12, 14};
  std::vector<double> rounds = {0, 1.5, 2};
  bool curve = false;
};

[[noreturn]] void die(const std::string& what, const Error& error) {
  std::fprintf(stderr, "stream: %s: %s\n", what.c_str(), error.message.c_str());
  std::exit(1);
}

Mesh plain_mesh(const std::filesystem::path& path) {
  const Result<MeshFile> file = read_mesh(path);
  if (!file) die(path.string(), file.error());
  TriangleSoup soup = to_soup(file->mesh);
  soup.attributes.clear();
  soup.face_material.clear();
  auto assembled = assemble(soup);
  if (!assembled) die(path.string(), assembled.error());
  return std::move(assembled->mesh);
}

CompactGrid grid_of(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.high - box.low;
  return {to_float(box.low), static_cast<float>(std::max({size.x, size.y, size.z}))};
}

double draco_bits(const Mesh& mesh, int bits, int level) {
  const CompactGrid grid = grid_of(mesh);
  detail::QuantizationGrids grids;
  grids.position = {{grid.origin.x, grid.origin.y, grid.origin.z}, grid.range, bits};
  const auto primitive = detail::encode_draco(mesh, grids, {}, level);
  if (!primitive) die("Draco", primitive.error());
  return 8 * static_cast<double>(primitive->bytes.size());
}

/// CPU time, since the machine may be shared; only one thread works here.
double seconds_since(std::clock_t start) { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }

/// Prints what each chunk leads to: its share of the bytes, faces, mean and largest deviation.
void print_curve(const Mesh& mesh, const CompactStream& stream, const ProgressiveMesh& coded) {
  const auto chunks = read_compact_chunks(stream.bytes);
  const double diagonal = bounding_box(mesh).diagonal();
  for (const CompactChunk& chunk : *chunks) {
    const Index position = chunk.record_begin + chunk.record_count;
    const Deviation deviation = measure_deviation(mesh, extract_level(coded, position));
    std::printf(
        "  %6.2f %% of the bytes: %7llu faces, mean %.5f %%, largest %.4f %%, bound %.4f %% of the diagonal\n",
        100.0 * static_cast<double>(chunk.byte_offset + chunk.byte_length) / static_cast<double>(stream.bytes.size()),
        static_cast<unsigned long long>(chunk.face_count), 100 * deviation.forward.mean / diagonal,
        100 * deviation.maximum() / diagonal, 100 * static_cast<double>(chunk.deviation) / diagonal);
  }
}

/// Prints a line; returns the stream's size over Draco's at level 7.
double print_line(const std::string& name, const Mesh& mesh, const ProgressiveMesh& records, int bits, bool curve) {
  CompactOptions options;
  options.grid_bits = bits;
  options.grid = grid_of(mesh);
  const std::clock_t encoding = std::clock();
  const auto stream = encode_compact(records, options);
  const double encode_seconds = seconds_since(encoding);
  if (!stream) die(name, stream.error());
  const std::clock_t decoding = std::clock();
  const auto coded = decode_compact(stream->bytes);
  const double decode_seconds = seconds_since(decoding);
  if (!coded) die(name, coded.error());
  if (const auto valid = validate(*coded); !valid) die(name, valid.error());

  const auto count = static_cast<double>(records.positions.size());
  const double total = 8 * static_cast<double>(stream->bytes.size());
  const double level7 = draco_bits(mesh, bits, 7), level10 = draco_bits(mesh, bits, 10);
  const CompactSizes& s = stream->sizes;
  std::printf("| %s | %zu | **%.2f** | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.3f | %.2f / %.2f |\n", name.c_str(),
              stream->round_count, total / count, s.places / count, s.positions / count, s.base / count,
              (s.errors + s.header) / count, level7 / count, level10 / count, total / level7,
              1e6 * encode_seconds / count, 1e6 * decode_seconds / count);
  if (curve) print_curve(mesh, *stream, *coded);
  return total / level7;
}

void print_table(const std::vector<std::pair<std::string, Mesh>>& meshes, double rounds, const Options& options) {
  std::vector<ProgressiveMesh> records;
  for (const auto& [name, mesh] : meshes) {
    SimplifyOptions simplify_options;
    simplify_options.dense_rounds = rounds;
    auto result = simplify(mesh, simplify_options);
    if (!result) die(name, result.error());
    records.push_back(std::move(result->mesh));
  }
  for (const int bits : options.bits) {
    std::printf("\nPositions of %d bits, dense_rounds = %g; bits for each vertex, microseconds for each vertex\n\n",
                bits, rounds);
    std::printf(
        "| | rounds | stream | places | positions | base | rest | Draco cl 7 | cl 10 | stream over cl 7 | encode / "
        "decode |\n");
    std::printf("|---|---|---|---|---|---|---|---|---|---|---|\n");
    double logs = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      logs += std::log(print_line(meshes[i].first, meshes[i].second, records[i], bits, options.curve));
    std::printf("| geometric mean | | | | | | | | | **%.3f** | |\n",
                std::exp(logs / static_cast<double>(meshes.size())));
  }
}

int run(int argc, char** argv) {
  Options options;
  if (const char* data = std::getenv("LODESTONE_DATA")) options.data = data;
  CLI::App app("Bits of compact streams beside Draco");
  app.add_option("files", options.files, "meshes, by themselves or in the folder of models");
  app.add_option("--data", options.data, "folder of models");
  app.add_option("--bits", options.bits, "bits of positions")->delimiter(',')->allow_extra_args(false);
  app.add_option("--rounds", options.rounds, "SimplifyOptions::dense_rounds")->delimiter(',')->allow_extra_args(false);
  app.add_flag("--curve", options.curve, "what each chunk leads to");
  CLI11_PARSE(app, argc, argv);

  std::vector<std::pair<std::string, Mesh>> meshes;
  for (const std::string& file : options.files) {
    const std::filesystem::path there = std::filesystem::path(options.data) / file;
    const std::filesystem::path path = std::filesystem::exists(file) ? std::filesystem::path(file) : there;
    meshes.emplace_back(path.stem().string(), plain_mesh(path));
  }
  for (const double rounds : options.rounds) print_table(meshes, rounds, options);
  return 0;
}

}  // namespace
}  // namespace lodestone::bench

int main(int argc, char** argv) { return lodestone::bench::run(argc, argv); }

// Bits for each vertex of compact streams, by part, beside Draco and meshoptimizer with zstd on the same grids:
// positions alone, and scenes with attributes. The whole of either file counts. Streams are decoded again, so that the
// times of both ways are there, and checked.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/place_levels.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_options.h>

#include "gltf/draco_encode.h"
#include "meshopt_bits.h"
#include "rates.h"

namespace lodestone::bench {
namespace {

struct Options {
  std::string data = "../shared/data";
  std::vector<std::string> files = {"paper/stanford-bunny.obj", "paper/fandisk.obj", "mesh/rocker-arm.obj",
                                    "mesh/homer.obj",           "mesh/cow.obj",      "mesh/cheburashka.obj"};
  std::vector<std::string> scenes = {"mesh/spot/spot_triangulated.obj", "gltf/FlightHelmet/FlightHelmet.gltf",
                                     "skin-morph/Knight.glb", "skin-morph/MorphStressTest.gltf"};
  std::vector<int> bits = {12, 14};
  std::vector<double> rounds = {0, kStreamDenseRounds};
  bool curve = false;
  bool placed = false;
  bool codings = false;
  std::string picture;
};

// What --picture draws where no files are named.
const std::vector<std::string> kDrawn = {"paper/stanford-bunny.obj", "mesh/rocker-arm.obj",
                                         "mesh/spot/spot_triangulated.obj", "gltf/FlightHelmet/FlightHelmet.gltf"};

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
        static_cast<unsigned long long>(chunk.face_count),
        100 * std::max(deviation.forward.mean, deviation.backward.mean) / diagonal,
        100 * deviation.maximum() / diagonal, 100 * static_cast<double>(chunk.deviation) / diagonal);
  }
}

/// Prints a line; returns the stream's size over Draco's at level 7.
double print_line(const std::string& name, const Mesh& mesh, const ProgressiveMesh& records, int bits, bool curve,
                  const std::vector<PlacedLevel>& placed) {
  CompactOptions options;
  options.grid_bits = bits;
  options.grid = grid_of(mesh);
  const std::clock_t encoding = std::clock();
  const auto stream = encode_compact(records, options, placed);
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
  std::printf("| %s | %zu | **%.2f** | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | %.3f | %.2f / %.2f |\n",
              name.c_str(), stream->round_count, total / count, s.places / count, s.positions / count, s.moves / count,
              s.base / count, (s.errors + s.header) / count, level7 / count, level10 / count,
              meshopt_bits(mesh, options) / count, total / level7, 1e6 * encode_seconds / count,
              1e6 * decode_seconds / count);
  if (curve) print_curve(mesh, *stream, *coded);
  return total / level7;
}

std::vector<PlacedLevel> place(const Mesh& mesh, const ProgressiveMesh& records) {
  return place_levels(LevelFitter(mesh), MeasuredSurface(mesh), records);
}

void print_table(const std::vector<std::pair<std::string, Mesh>>& meshes, double rounds, const Options& options) {
  std::vector<ProgressiveMesh> records;
  std::vector<std::vector<PlacedLevel>> placed;
  for (const auto& [name, mesh] : meshes) {
    SimplifyOptions simplify_options;
    simplify_options.dense_rounds = rounds;
    auto result = simplify(mesh, simplify_options);
    if (!result) die(name, result.error());
    records.push_back(std::move(result->mesh));
    placed.emplace_back();
    if (options.placed) placed.back() = place(mesh, records.back());
  }
  for (const int bits : options.bits) {
    std::printf("\nPositions of %d bits, dense_rounds = %g; bits for each vertex, microseconds for each vertex\n\n",
                bits, rounds);
    std::printf(
        "| | rounds | stream | places | positions | moves | base | rest | Draco cl 7 | cl 10 | meshopt + zstd | stream "
        "over "
        "cl 7 | encode / decode |\n");
    std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    double logs = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      logs += std::log(print_line(meshes[i].first, meshes[i].second, records[i], bits, options.curve, placed[i]));
    std::printf("| geometric mean | | | | | | | | | | | **%.3f** | |\n",
                std::exp(logs / static_cast<double>(meshes.size())));
  }
}

/// The meshes of a scene, or the one of a file; of their attributes only those that have one of these names, or all.
std::vector<Mesh> scene_meshes(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const auto scene = Scene::read(path);
  if (!scene) die(path.string(), scene.error());
  std::vector<Mesh> meshes;
  for (const SceneMesh& given : scene->meshes()) {
    TriangleSoup soup = to_soup(given.mesh);
    std::erase_if(soup.attributes, [&](const Attribute& attribute) {
      return !names.empty() && std::find(names.begin(), names.end(), attribute.name) == names.end();
    });
    auto assembled = assemble(soup);
    if (!assembled) die(path.string(), assembled.error());
    meshes.push_back(std::move(assembled->mesh));
  }
  return meshes;
}

detail::QuantizationGrid attribute_grid(const Attribute& attribute, const CompactOptions& options) {
  if (attribute.type != ComponentType::Float32) return {{}, 1, 0};
  const std::vector<float> values = attribute_values(attribute);
  const std::size_t size = attribute.component_count;
  std::vector<float> low(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size)), high = low;
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % size] = std::min(low[i % size], values[i]);
    high[i % size] = std::max(high[i % size], values[i]);
  }
  float range = 0;
  for (std::size_t c = 0; c < size; ++c) range = std::max(range, high[c] - low[c]);
  const bool is_texture = attribute.name.starts_with("TEXCOORD_");
  const int bits = attribute.name == "NORMAL" || attribute.name == "TANGENT" ? options.normal_bits
                   : is_texture                                              ? options.texture_bits
                   : attribute.name.starts_with("WEIGHTS_")                  ? options.weight_bits
                                                                             : options.other_bits;
  return {low, range > 0 ? range : 1, bits};
}

double draco_scene_bits(const Mesh& mesh, const CompactOptions& options, int level) {
  std::vector<Index> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), Index{0});
  const Mesh ordered = pick_faces(mesh, faces);
  detail::QuantizationGrids grids;
  const CompactGrid& grid = *options.grid;
  grids.position = {{grid.origin.x, grid.origin.y, grid.origin.z}, grid.range, options.grid_bits};
  for (const Attribute& attribute : ordered.attributes) grids.attributes.push_back(attribute_grid(attribute, options));
  double best = 0;
  for (const auto prediction : {detail::DracoPrediction::Positions, detail::DracoPrediction::Neighbours}) {
    const auto primitive = detail::encode_draco(ordered, grids, {detail::DracoMethod::Edgebreaker, prediction}, level);
    if (!primitive) die("Draco", primitive.error());
    const double bits = 8 * static_cast<double>(primitive->bytes.size());
    best = best == 0 ? bits : std::min(best, bits);
  }
  return best;
}

/// What the streams of a scene's meshes take together.
struct SceneBits {
  double vertices = 0, wedges = 0, loose = 0;
  double total = 0, places = 0, wedge_bits = 0, loose_bits = 0, positions = 0, rest = 0;
  double draco7 = 0, draco10 = 0, meshopt = 0;
  std::vector<std::pair<std::string, double>> attributes;

  void add(const std::string& name, double bits) {
    for (auto& [known, sum] : attributes)
      if (known == name) {
        sum += bits;
        return;
      }
    attributes.emplace_back(name, bits);
  }
};

void add_mesh(const std::string& name, const Mesh& mesh, double rounds, int bits, SceneBits& sum) {
  SimplifyOptions simplify_options;
  simplify_options.dense_rounds = rounds;
  const auto records = simplify(mesh, simplify_options);
  if (!records) die(name, records.error());
  CompactOptions options;
  options.grid_bits = bits;
  options.grid = grid_of(mesh);
  const auto stream = encode_compact(records->mesh, options);
  if (!stream) die(name, stream.error());
  const auto coded = decode_compact(stream->bytes);
  if (!coded) die(name, coded.error());
  if (const auto valid = validate(*coded); !valid) die(name, valid.error());
  const CompactSizes& s = stream->sizes;
  sum.vertices += static_cast<double>(records->mesh.positions.size());
  sum.wedges += static_cast<double>(records->mesh.wedge_vertex.size());
  sum.loose += static_cast<double>(stream->loose_count);
  sum.total += 8 * static_cast<double>(stream->bytes.size());
  sum.places += s.places;
  sum.wedge_bits += s.wedges;
  sum.loose_bits += s.loose;
  sum.positions += s.positions;
  sum.rest += s.base + s.errors + s.header;
  for (std::size_t a = 0; a < s.attributes.size(); ++a) sum.add(mesh.attributes[a].name, s.attributes[a]);
  sum.draco7 += draco_scene_bits(mesh, options, 7);
  sum.draco10 += draco_scene_bits(mesh, options, 10);
  sum.meshopt += meshopt_bits(mesh, options);
}

void print_scene(const std::string& name, const std::vector<Mesh>& meshes, double rounds, int bits) {
  SceneBits sum;
  for (const Mesh& mesh : meshes) add_mesh(name, mesh, rounds, bits, sum);
  const double n = sum.vertices;
  std::printf("| %s | %.0f / %.0f | **%.2f** | %.2f | %.2f | %.2f | %.2f | %.2f | ", name.c_str(), n, sum.wedges,
              sum.total / n, sum.places / n, sum.wedge_bits / n, sum.loose_bits / n, sum.positions / n, sum.rest / n);
  for (const auto& [attribute, attribute_bits] : sum.attributes)
    std::printf("%s %.2f ", attribute.c_str(), attribute_bits / n);
  std::printf("| %.2f | %.2f | %.2f | **%.3f** |\n", sum.draco7 / n, sum.draco10 / n, sum.meshopt / n,
              sum.total / sum.draco7);
  if (sum.loose > 0) std::printf("  (%.0f records told face by face)\n", sum.loose);
}

void print_scenes(const std::vector<std::filesystem::path>& paths, double rounds, int bits) {
  std::printf(
      "\nScenes: positions of %d bits, normals of 10, other floats of 12; dense_rounds = %g; bits for each vertex\n\n",
      bits, rounds);
  std::printf(
      "| | vertices / wedges | stream | places | wedges | loose | positions | rest | attributes | Draco cl 7 | cl 10 | "
      "meshopt + zstd | stream over cl 7 |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& path : paths) {
    const std::string name = path.stem().string();
    print_scene(name, scene_meshes(path, {"NORMAL", "TEXCOORD_0"}), rounds, bits);
    print_scene(name + ", all attributes", scene_meshes(path, {}), rounds, bits);
  }
}

/// What a coding makes of a scene's meshes: bits, and the CPU seconds of the fastest of five decodings.
struct Coded {
  double bits = 0, seconds = 0, vertices = 0, records = 0;
};

void add_coded(const std::string& name, const Mesh& mesh, const ProgressiveMesh& records,
               const std::vector<PlacedLevel>& placed, const CompactOptions& options, Coded& sum) {
  const auto stream = encode_compact(records, options, placed);
  if (!stream) die(name, stream.error());
  double best = HUGE_VAL;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t start = std::clock();
    const auto coded = decode_compact(stream->bytes);
    best = std::min(best, seconds_since(start));
    if (!coded) die(name, coded.error());
  }
  sum.bits += 8 * static_cast<double>(stream->bytes.size());
  sum.seconds += best;
  sum.vertices += static_cast<double>(mesh.positions.size());
  sum.records += static_cast<double>(records.record_count());
}

/// Prints what small and fast coding take and how fast they are decoded, of streams with placed levels as `build` makes
/// them, of all meshes of a file with all their attributes.
void print_codings(const std::vector<std::filesystem::path>& paths, int bits) {
  std::printf("\nPositions of %d bits, dense_rounds = %g, placed levels\n\n", bits, kStreamDenseRounds);
  std::printf(
      "| | bits a vertex, small | fast | more | thousand records a second, small | fast | times |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const auto& path : paths) {
    Coded small, fast;
    for (const Mesh& mesh : scene_meshes(path, {})) {
      SimplifyOptions simplify_options;
      simplify_options.dense_rounds = kStreamDenseRounds;
      const auto records = simplify(mesh, simplify_options);
      if (!records) die(path.string(), records.error());
      const std::vector<PlacedLevel> placed = place(mesh, records->mesh);
      CompactOptions options;
      options.grid_bits = bits;
      options.grid = grid_of(mesh);
      add_coded(path.string(), mesh, records->mesh, placed, options, small);
      options.coding = CompactCoding::Fast;
      add_coded(path.string(), mesh, records->mesh, placed, options, fast);
    }
    const double before = small.bits / small.vertices, after = fast.bits / fast.vertices;
    const double slow_rate = small.records / small.seconds, fast_rate = fast.records / fast.seconds;
    std::printf("| %s | %.2f | %.2f | %.2f | %.0f | %.0f | %.2f |\n", path.stem().string().c_str(), before, after,
                after - before, slow_rate / 1000, fast_rate / 1000, fast_rate / slow_rate);
  }
}

int run(int argc, char** argv) {
  Options options;
  if (const char* data = std::getenv("LODESTONE_DATA")) options.data = data;
  CLI::App app("Bits of compact streams beside Draco");
  app.add_option("files", options.files, "meshes, by themselves or in the folder of models");
  app.add_option("--scenes", options.scenes, "files whose attributes count, too; none for ''")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--data", options.data, "folder of models");
  app.add_option("--bits", options.bits, "bits of positions")->delimiter(',')->allow_extra_args(false);
  app.add_option("--rounds", options.rounds, "SimplifyOptions::dense_rounds")->delimiter(',')->allow_extra_args(false);
  app.add_flag("--placed", options.placed, "with levels that are placed closer to the full mesh");
  app.add_flag("--codings", options.codings,
               "small coding beside fast, of files and scenes with all attributes; no other table");
  app.add_flag("--curve", options.curve, "what each chunk leads to");
  app.add_option(
      "--picture", options.picture,
      "SVG file to draw: error against bytes beside levels by Draco, of the files or of four models; no table of bits");
  CLI11_PARSE(app, argc, argv);

  const auto path_of = [&](const std::string& file) {
    return std::filesystem::exists(file) ? std::filesystem::path(file) : std::filesystem::path(options.data) / file;
  };
  if (!options.picture.empty()) {
    std::vector<std::filesystem::path> models;
    for (const std::string& file : app.count("files") > 0 ? options.files : kDrawn) models.push_back(path_of(file));
    return draw_rates(models, options.picture);
  }
  std::vector<std::pair<std::string, Mesh>> meshes;
  for (const std::string& file : options.files)
    if (!file.empty()) meshes.emplace_back(path_of(file).stem().string(), plain_mesh(path_of(file)));
  std::vector<std::filesystem::path> scenes;
  for (const std::string& file : options.scenes)
    if (!file.empty()) scenes.push_back(path_of(file));
  if (options.codings) {
    std::vector<std::filesystem::path> paths;
    for (const std::string& file : options.files)
      if (!file.empty()) paths.push_back(path_of(file));
    paths.insert(paths.end(), scenes.begin(), scenes.end());
    for (const int bits : options.bits) print_codings(paths, bits);
    return 0;
  }
  for (const double rounds : options.rounds) {
    if (!meshes.empty()) print_table(meshes, rounds, options);
    for (const int bits : options.bits)
      if (!scenes.empty()) print_scenes(scenes, rounds, bits);
  }
  return 0;
}

}  // namespace
}  // namespace lodestone::bench

int main(int argc, char** argv) { return lodestone::bench::run(argc, argv); }

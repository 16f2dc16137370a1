#include "compare_command.h"

#include <cstdio>
#include <numbers>

#include <CLI/CLI.hpp>

#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/deviation.h>

#include "json_text.h"
#include "messages.h"
#include "progress_bar.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr int kCompareSchemaVersion = 1;

struct Surface {
  std::string path;
  Mesh mesh;
};

Result<Surface> read_surface(const std::filesystem::path& path) {
  Result<MeshFile> file = read_mesh(path);
  if (!file) return tl::unexpected(file.error());
  if (file->mesh.face_count() == 0) {
    return fail(ErrorCode::Malformed, quoted(path) + ": no triangles to compare");
  }
  return Surface{path.string(), std::move(file->mesh)};
}

Json surface_json(const Surface& surface) {
  return {{"path", surface.path}, {"faces", surface.mesh.face_count()}, {"vertices", surface.mesh.vertex_count()}};
}

Json percent_json(const OneSidedDeviation& deviation, double diagonal) {
  const double scale = 100 / diagonal;
  return {{"max", deviation.maximum * scale}, {"mean", deviation.mean * scale}, {"rms", deviation.rms * scale}};
}

Json comparison_json(const Surface& a, const Surface& b, const Deviation& deviation, double diagonal) {
  return {{"schema_version", kCompareSchemaVersion},
          {"a", surface_json(a)},
          {"b", surface_json(b)},
          {"diagonal", diagonal},
          {"deviation", deviation_json(deviation)},
          {"percent_of_diagonal",
           {{"forward", percent_json(deviation.forward, diagonal)},
            {"backward", percent_json(deviation.backward, diagonal)}}}};
}

std::vector<std::string> row_of(const char* name, const OneSidedDeviation& way, double diagonal) {
  return {name,
          number_text(way.maximum),
          number_text(way.mean),
          number_text(way.rms),
          percent_text(way.maximum, diagonal),
          percent_text(way.mean, diagonal),
          percent_text(way.rms, diagonal)};
}

void print_comparison(const Surface& a, const Surface& b, const Deviation& deviation, double diagonal) {
  std::printf("A: %s, %zu faces, diagonal %s\n", a.path.c_str(), a.mesh.face_count(), number_text(diagonal).c_str());
  std::printf("B: %s, %zu faces\n", b.path.c_str(), b.mesh.face_count());
  TextTable table({"", "max", "mean", "rms", "max %", "mean %", "rms %"});
  table.add(row_of("A to B", deviation.forward, diagonal));
  table.add(row_of("B to A", deviation.backward, diagonal));
  table.print();
  const double degrees = deviation.mean_normal_angle * 180 / std::numbers::pi;
  std::printf("mean angle between normals: %s degrees\n", number_text(degrees, 4).c_str());
}

}  // namespace

void CompareCommand::add_to(CLI::App& app) {
  app.add_option("A", first, "Mesh file; percentages are of its bounding-box diagonal")->required()->type_name("FILE");
  app.add_option("B", second, "Mesh file")->required()->type_name("FILE");
  app.add_flag("--json", json, "Print JSON");
  app.footer("Example:\n  lodestone compare bunny.obj bunny-855.obj");
}

Result<Outcome> CompareCommand::run() const {
  ProgressBar progress(true);
  progress.start("reading");
  const Result<Surface> a = read_surface(first);
  if (!a) return tl::unexpected(a.error());
  const Result<Surface> b = read_surface(second);
  if (!b) return tl::unexpected(b.error());
  progress.start("measuring");
  const Deviation deviation = measure_deviation(a->mesh, b->mesh);
  progress.clear();
  const double diagonal = bounding_box(a->mesh).diagonal();
  if (json) {
    std::fputs(json_text(comparison_json(*a, *b, deviation, diagonal)).c_str(), stdout);
  } else {
    print_comparison(*a, *b, deviation, diagonal);
  }
  return Outcome::Done;
}

}  // namespace lodestone::tool

#include "compare_command.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <system_error>

#include <CLI/CLI.hpp>

#include <lodestone/core/detail/try.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/deviation.h>

#include "error_map.h"
#include "heatmap.h"
#include "html_report.h"
#include "input_files.h"
#include "json_text.h"
#include "messages.h"
#include "progress_bar.h"
#include "staged_file.h"
#include "standard_streams.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr int kCompareSchemaVersion = 1;
constexpr std::size_t kMostSamples = 1'000'000'000;

struct Surface {
  std::string path;
  Mesh mesh;
  std::uint64_t bytes = 0;  ///< of the file and what it needs beside it
};

Result<Surface> read_surface(const std::filesystem::path& path) {
  LODESTONE_TRY(MeshFile file, read_mesh_file(path));
  if (file.mesh.face_count() == 0) {
    return fail(ErrorCode::Malformed, quoted(path) + ": no triangles to compare");
  }
  return Surface{path.string(), std::move(file.mesh), loaded_bytes(path).value_or(0)};
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

/// The page shows the same numbers, the bytes of the files, and how far the attributes agree.
Result<std::string> comparison_page(const Surface& a, const Surface& b, const Json& comparison, double diagonal) {
  HtmlReport page;
  const auto name = [](const Surface& surface) { return std::filesystem::path(surface.path).filename().string(); };
  page.title = name(b) + " against " + name(a);
  page.diagonal = diagonal;
  page.numbers = {{"kind", "compare"},
                  {"comparison", comparison},
                  {"bytes", {a.bytes, b.bytes}},
                  {"attributes", attributes_json(measure_attributes(a.mesh, b.mesh))}};
  page.meshes = {a.mesh, b.mesh};
  return html_page(page);
}

struct Heatmap {
  std::vector<std::byte> bytes;
  double upper = 0;  ///< what the darkest colour stands for
};

/// Colours end where 99 % of the area do: with a few peaks at their end, all the rest would be pale.
Result<Heatmap> make_heatmap(const std::filesystem::path& path, const Surface& a, const Surface& b) {
  const SurfaceIndex surface(b.mesh);
  const std::vector<float> errors = vertex_errors(a.mesh, surface);
  const double largest = *std::max_element(errors.begin(), errors.end());
  const double nearly_all = measure_spread(a.mesh, surface, largest).nearly_all;
  const double upper = nearly_all > 0 ? nearly_all : largest;
  LODESTONE_TRY(std::vector<std::byte> bytes, encode_heatmap(path, a.mesh, errors, upper));
  return Heatmap{std::move(bytes), upper};
}

Result<void> check_output(const char* option, const std::filesystem::path& path, const CompareCommand& options) {
  std::error_code ignored;
  for (const std::filesystem::path& input : {options.first, options.second}) {
    if (std::filesystem::equivalent(input, path, ignored))
      return fail(ErrorCode::InvalidArgument, std::string(option) + ": " + quoted(path) + " is an input");
  }
  return check_destination(path);
}

Result<void> check_outputs(const CompareCommand& options) {
  if (is_standard_stream(options.first) && is_standard_stream(options.second))
    return fail(ErrorCode::InvalidArgument, "the standard input can be A or B, not both");
  if (options.heatmap) {
    LODESTONE_CHECK(check_heatmap_path(*options.heatmap));
    LODESTONE_CHECK(check_output("--heatmap", *options.heatmap, options));
  }
  if (!options.html) return {};
  if (options.heatmap && options.heatmap->lexically_normal() == options.html->lexically_normal())
    return fail(ErrorCode::InvalidArgument, "--html: " + quoted(*options.html) + " is the heatmap");
  return check_output("--html", *options.html, options);
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
  app.add_option("A", first,
                 "Mesh file; percentages are of its bounding-box diagonal. Of A and B one may be - for standard input")
      ->required()
      ->type_name("FILE");
  app.add_option("B", second, "Mesh file")->required()->type_name("FILE");
  app.add_flag("--json", json, "Print JSON");
  app.add_option("--samples", samples, "About so many samples of each surface for mean and rms; the maximum needs none")
      ->type_name("COUNT")
      ->check(CLI::Range(std::size_t{1000}, kMostSamples))
      ->capture_default_str();
  app.add_option("--html", html, "Write a page that shows both surfaces, the errors and where these are")
      ->type_name("P.html");
  app.add_option("--heatmap", heatmap, "Write A coloured by its distance from B, as .ply or .glb")->type_name("X");
  app.footer(
      "Examples:\n"
      "  lodestone compare bunny.obj bunny-855.obj\n"
      "  lodestone compare bunny.obj bunny-855.obj --html bunny.html --heatmap bunny-errors.ply");
}

Result<Outcome> CompareCommand::run() const {
  LODESTONE_CHECK(check_outputs(*this));
  ProgressBar progress(true);
  progress.update("reading", 0);
  LODESTONE_TRY(const Surface a, read_surface(first));
  LODESTONE_TRY(const Surface b, read_surface(second));
  progress.update("measuring", 0.1);
  DeviationOptions how;
  how.sample_count = samples;
  const Deviation deviation = measure_deviation(a.mesh, b.mesh, how);
  const double diagonal = bounding_box(a.mesh).diagonal();
  const Json comparison = comparison_json(a, b, deviation, diagonal);

  StagedFiles files;
  if (html) {
    progress.update("drawing", 0.6);
    LODESTONE_TRY(const std::string page, comparison_page(a, b, comparison, diagonal));
    LODESTONE_CHECK(files.add(*html, page));
  }
  double upper = 0;
  if (heatmap) {
    LODESTONE_TRY(const Heatmap colours, make_heatmap(*heatmap, a, b));
    upper = colours.upper;
    LODESTONE_CHECK(files.add(*heatmap, colours.bytes));
  }
  progress.clear();
  LODESTONE_CHECK(files.commit());

  if (json) {
    std::fputs(json_text(comparison).c_str(), stdout);
    return Outcome::Done;
  }
  print_comparison(a, b, deviation, diagonal);
  if (heatmap)
    std::printf("%s: from pale, no error, to dark, %s (%s of the diagonal) and more\n", heatmap->string().c_str(),
                number_text(upper).c_str(), percent_text(upper, diagonal).c_str());
  return Outcome::Done;
}

}  // namespace lodestone::tool

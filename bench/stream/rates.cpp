#include "rates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <utility>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/pipeline/build_asset.h>

#include "picture/picture.h"

namespace lodestone::bench {
namespace {

// Of the faces: the levels by Draco, at each of these grids.
constexpr std::array kShares = {0.7, 0.5, 0.35, 0.25, 0.17, 0.12, 0.08, 0.05, 0.035, 0.024, 0.016, 0.011, 0.007, 0.005};
constexpr std::array kGridBits = {14, 12, 11, 10};
constexpr std::array kParts = {0.05, 0.1, 0.25, 0.5};  // of the stream's bytes
constexpr double kBytes = 1000;                        // costs are kilobytes

double error_of(const Deviation& deviation, double diagonal) {
  return 100 * std::max(deviation.forward.mean, deviation.backward.mean) / diagonal;
}

CostedError point_of(std::uint64_t bytes, double error) { return {static_cast<double>(bytes) / kBytes, error, ""}; }

/// What the bytes up to each chunk's end show.
Result<std::vector<CostedError>> stream_points(const Scene& scene) {
  BuildOptions options;
  options.layout = FileLayout::StreamAlone;
  options.targets.clear();
  auto built = build_asset(scene, options);
  if (!built) return tl::unexpected(built.error());
  const std::vector<std::byte>& stream = built->files[0].glb;
  const auto decoded = decode_compact(stream);
  if (!decoded) return tl::unexpected(decoded.error());
  const Mesh& whole = scene.meshes()[0].mesh;
  const MeasuredSurface surface(whole);
  std::vector<CostedError> points;
  const auto chunks = read_compact_chunks(stream);
  if (!chunks) return tl::unexpected(chunks.error());
  for (const CompactChunk& chunk : *chunks) {
    const Mesh level = extract_level(*decoded, chunk.record_begin + chunk.record_count);
    const Deviation deviation = measure_deviation(surface, MeasuredSurface(level));
    points.push_back(
        point_of(chunk.byte_offset + chunk.byte_length, error_of(deviation, bounding_box(whole).diagonal())));
  }
  return points;
}

/// Levels on one grid, coarse to fine, as they come out of the file.
Result<std::vector<CostedError>> draco_points(const Scene& scene, int bits) {
  BuildOptions options;
  options.stream = false;
  options.storage.position_bits = bits;
  options.targets.clear();
  for (const double share : kShares) options.targets.push_back({TargetKind::Faces, share, true, false});
  auto built = build_asset(scene, options);
  if (!built) return tl::unexpected(built.error());
  std::vector<CostedError> points;
  for (const BuildResult::Level& level : built->levels)
    points.push_back(point_of(level.bytes, error_of(level.deviation, scene.box().diagonal())));
  std::reverse(points.begin(), points.end());
  return points;
}

/// Those that no other has fewer bytes and less error than.
std::vector<CostedError> best_of(std::vector<CostedError> points) {
  std::sort(points.begin(), points.end(), [](const CostedError& a, const CostedError& b) {
    return std::pair(a.cost, a.error) < std::pair(b.cost, b.error);
  });
  std::vector<CostedError> best;
  for (const CostedError& point : points)
    if (best.empty() || point.error < best.back().error) best.push_back(point);
  return best;
}

/// The error at a cost, between the points around it on logarithmic axes.
std::optional<double> error_at(const std::vector<CostedError>& points, double cost) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const CostedError &a = points[i - 1], &b = points[i];
    if (cost < a.cost || cost > b.cost) continue;
    const double t = std::log(cost / a.cost) / std::log(b.cost / a.cost);
    return std::exp((1 - t) * std::log(a.error) + t * std::log(b.error));
  }
  return std::nullopt;
}

/// What a stream shows when so much of it is there: its last whole chunk.
std::optional<double> shown_at(const std::vector<CostedError>& points, double cost) {
  std::optional<double> error;
  for (const CostedError& point : points)
    if (point.cost <= cost) error = point.error;
  return error;
}

void print_cell(std::optional<double> error, std::optional<double> over = {}) {
  if (!error)
    std::printf(" – |");
  else if (over)
    std::printf(" %.4f (%.2f) |", *error, *over / *error);
  else
    std::printf(" %.4f |", *error);
}

void print_rows(const ErrorPanel& panel) {
  const std::vector<CostedError>& stream = panel.series[0].points;
  for (const double part : kParts) {
    const double cost = part * stream.back().cost;
    const std::optional<double> shown = shown_at(stream, cost);
    std::printf("| %s | %.0f %%, %.1f kB |", panel.title.c_str(), 100 * part, cost);
    print_cell(shown);
    print_cell(error_at(panel.series[1].points, cost), shown);
    print_cell(error_at(panel.series[2].points, cost), shown);
    std::printf("\n");
  }
}

Result<ErrorPanel> panel_of(const std::filesystem::path& model) {
  auto file = read_mesh(model);
  if (!file) return tl::unexpected(file.error());
  const auto scene = Scene::from_mesh(std::move(*file), model.stem().string());
  if (!scene) return tl::unexpected(scene.error());
  auto stream = stream_points(*scene);
  if (!stream) return tl::unexpected(stream.error());
  std::vector<CostedError> all, usual;
  for (const int bits : kGridBits) {
    auto points = draco_points(*scene, bits);
    if (!points) return tl::unexpected(points.error());
    all.insert(all.end(), points->begin(), points->end());
    if (bits == kGridBits[0]) usual = std::move(*points);
  }
  ErrorPanel panel{model.stem().string(), {}, {}};
  for (const double part : kParts)
    panel.marks.push_back({part * stream->back().cost, std::to_string(std::lround(100 * part)) + " %"});
  panel.series = {{"the stream, as its chunks arrive", std::move(*stream), true},
                  {"one level by Draco, positions of 14 bits", std::move(usual), false},
                  {"one level by Draco, the best of 10 to 14 bits", best_of(std::move(all)), false}};
  return panel;
}

}  // namespace

int draw_rates(const std::vector<std::filesystem::path>& models, const std::string& picture) {
  std::vector<ErrorPanel> panels;
  std::printf("| | of the stream | stream | Draco, 14 bits (stream over it) | Draco, best bits (stream over it) |\n");
  std::printf("|---|---|---|---|---|\n");
  for (const std::filesystem::path& model : models) {
    auto panel = panel_of(model);
    if (!panel) {
      std::fprintf(stderr, "stream: %s: %s\n", model.c_str(), panel.error().message.c_str());
      return 1;
    }
    print_rows(*panel);
    panels.push_back(std::move(*panel));
  }
  std::ofstream out(picture);
  out << error_picture(panels, "kB", 2);
  if (out.flush()) return 0;
  std::fprintf(stderr, "stream: %s: not writable\n", picture.c_str());
  return 4;
}

}  // namespace lodestone::bench

#include "build_output.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <system_error>

#include "build_options.h"
#include "messages.h"
#include "staged_file.h"

namespace lodestone::tool {
namespace {

/// Raised whenever a member changes its meaning or goes away.
constexpr int kIndexSchemaVersion = 1;

Result<void> check_path(const BuildCommand& options, const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::equivalent(options.input, path, ignored)) {
    return fail(ErrorCode::InvalidArgument, "-o: " + quoted(path) + " is the input");
  }
  if (options.report && options.report->lexically_normal() == path.lexically_normal()) {
    return fail(ErrorCode::InvalidArgument, "--report: " + quoted(*options.report) + " is the output");
  }
  return check_destination(path);
}

Result<void> check_page_path(const BuildCommand& options, std::size_t level_count) {
  std::error_code ignored;
  if (std::filesystem::equivalent(options.input, *options.html, ignored)) {
    return fail(ErrorCode::InvalidArgument, "--html: " + quoted(*options.html) + " is the input");
  }
  std::vector<std::filesystem::path> others = output_paths(options, level_count);
  if (options.report) others.push_back(*options.report);
  for (const std::filesystem::path& other : others) {
    if (options.html->lexically_normal() == other.lexically_normal())
      return fail(ErrorCode::InvalidArgument, "--html: " + quoted(*options.html) + " is another output");
  }
  return check_destination(*options.html);
}

/// The index of `--profile files`: which file to load when.
Json index_json(const BuildReport& report) {
  Json levels = Json::array();
  double coverage = 1;
  for (std::size_t i = 0; i < report.levels.size(); ++i) {
    const BuildReport::Level& level = report.levels[i];
    const Deviation& d = level.deviation;
    const bool last = i + 1 == report.levels.size();
    if (!last) {
      const double next = screen_coverage(report.input.box.diagonal(), report.levels[i + 1].deviation.maximum());
      coverage = std::min(coverage, next);
    }
    levels.push_back({{"file", std::filesystem::path(report.files[i].path).filename().string()},
                      {"faces", level.face_count},
                      {"vertices", level.vertex_count},
                      {"bytes", report.files[i].bytes},
                      {"deviation",
                       {{"max", d.maximum()},
                        {"mean", std::max(d.forward.mean, d.backward.mean)},
                        {"rms", std::max(d.forward.rms, d.backward.rms)}}},
                      {"error_threshold", level.deviation_bound},
                      {"screen_coverage", last ? 0 : coverage}});
  }
  return {{"schema_version", kIndexSchemaVersion},
          {"generator", "lodestone " LODESTONE_VERSION},
          {"bounding_box", box_json(report.input.box)},
          {"levels", std::move(levels)}};
}

}  // namespace

std::vector<std::filesystem::path> output_paths(const BuildCommand& options, std::size_t level_count) {
  if (!has_file_per_level(options)) return {options.output};
  std::vector<std::filesystem::path> paths;
  for (std::size_t i = 0; i < level_count; ++i) {
    paths.push_back(options.output);
    paths.back().replace_filename(options.output.stem().string() + "_LOD" + std::to_string(i) + ".glb");
  }
  paths.push_back(options.output);
  paths.back().replace_extension(".json");
  return paths;
}

Result<void> check_paths(const BuildCommand& options, std::size_t level_count) {
  if (options.output.extension() != ".glb") {
    return fail(ErrorCode::InvalidArgument, "-o: " + quoted(options.output) + " does not end in .glb");
  }
  for (const std::filesystem::path& path : output_paths(options, level_count))
    if (Result<void> place = check_path(options, path); !place) return place;
  if (options.html) {
    if (Result<void> place = check_page_path(options, level_count); !place) return place;
  }
  return options.report ? check_destination(*options.report) : Result<void>();
}

void list_files(const BuildCommand& options, std::span<const EncodedAsset> assets, BuildReport& report) {
  const std::vector<std::filesystem::path> paths = output_paths(options, assets.size());
  for (std::size_t i = 0; i < assets.size(); ++i) {
    report.files.push_back({paths[i].string(), assets[i].layout.total_bytes});
    report.output_bytes += assets[i].layout.total_bytes;
  }
}

Result<void> write_outputs(const BuildCommand& options, std::span<const EncodedAsset> assets, const BuildReport& report,
                           const std::string& page) {
  const std::vector<std::filesystem::path> paths = output_paths(options, assets.size());
  StagedFiles files;
  for (std::size_t i = 0; i < assets.size(); ++i) {
    if (Result<void> done = files.add(paths[i], assets[i].glb); !done) return done;
  }
  if (has_file_per_level(options)) {
    if (Result<void> done = files.add(paths.back(), json_text(index_json(report))); !done) return done;
  }
  if (options.html) {
    if (Result<void> done = files.add(*options.html, page); !done) return done;
  }
  if (options.report) {
    if (Result<void> done = files.add(*options.report, json_text(report_json(report))); !done) return done;
  }
  return files.commit();
}

}  // namespace lodestone::tool

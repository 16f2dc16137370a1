#include "build_output.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <system_error>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/screen_coverage.h>
#include <lodestone/io/write_mesh.h>

#include "asset_files.h"
#include "build_options.h"
#include "file_words.h"
#include "messages.h"
#include "staged_file.h"
#include "standard_streams.h"

namespace lodestone::tool {
namespace {

using detail::text;

/// Raised whenever a member changes its meaning or goes away.
constexpr int kIndexSchemaVersion = 2;

/// What the names of levels begin with, in files of their own.
std::string level_stem(const BuildCommand& options) { return options.output.stem().string() + "_LOD"; }

/// Whether a file is called as a level is: STEM, a number, an extension of glTF or of its data.
bool is_level_name(const std::string& name, const std::string& stem) {
  if (!name.starts_with(stem)) return false;
  const std::size_t end = name.find_first_not_of("0123456789", stem.size());
  if (end == name.npos || end == stem.size()) return false;
  const std::string extension = extension_of(name.substr(stem.size()));
  return name.find('.', end) == end && (extension == "glb" || extension == "gltf");
}

/// A .gltf has files beside it, and so needs a place.
Result<void> check_format(const BuildCommand& options) {
  if (is_standard_stream(options.output)) {
    if (options.format == "gltf")
      return fail(ErrorCode::InvalidArgument, "--format: a .gltf is several files, the standard output takes one");
    if (has_file_per_level(options))
      return fail(ErrorCode::InvalidArgument, "--profile files writes several files, the standard output takes one");
    if (standard_output_is_terminal())
      return fail(ErrorCode::InvalidArgument, "-o: the standard output is a terminal: send it to a file or a program");
    return {};
  }
  const std::string extension = extension_of(options.output);
  const bool is_known = has_one_level(options) ? is_level_format(extension)
                                               : extension == "glb" || extension == "gltf" || extension == "lods";
  if (is_known) return {};
  std::string hint;
  if (extension.empty())
    hint = ": write '" + options.output.string() + ".glb', or '" + options.output.string() + "/' for a folder";
  if (extension == "obj" || extension == "ply") hint = "; lodestone simplify writes one of that kind";
  return fail(ErrorCode::InvalidArgument, "-o: " + quoted(options.output) + " does not end in " +
                                              (has_one_level(options) ? kLevelFormatNames : ".glb, .gltf or .lods") +
                                              hint);
}

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

/// The scene as one object: when to change from file to file.
std::vector<double> scene_coverages(const BuildReport& report) {
  std::vector<double> errors;
  for (const BuildResult::Level& level : report.build.levels) {
    const Deviation& d = level.deviation;
    errors.push_back(visible_error({std::max(d.forward.rms, d.backward.rms), d.mean_normal_angle, report.input.area,
                                    static_cast<double>(level.face_count)}));
  }
  const Vec3 sides = report.input.box.high - report.input.box.low;
  return screen_coverages(std::max({sides.x, sides.y, sides.z}), errors);
}

/// The index of `--profile files`: which file to load when.
Json index_json(const BuildReport& report) {
  Json levels = Json::array();
  const std::vector<double> coverages = scene_coverages(report);
  for (std::size_t i = 0; i < report.build.levels.size(); ++i) {
    const BuildResult::Level& level = report.build.levels[i];
    const Deviation& d = level.deviation;
    levels.push_back({{"file", std::filesystem::path(report.files[i].path).filename().string()},
                      {"faces", level.face_count},
                      {"vertices", level.vertex_count},
                      {"bytes", report.files[i].bytes},
                      {"deviation",
                       {{"max", d.maximum()},
                        {"mean", std::max(d.forward.mean, d.backward.mean)},
                        {"rms", std::max(d.forward.rms, d.backward.rms)}}},
                      {"error_threshold", std::min(level.deviation_bound, d.maximum_bound())},
                      {"screen_coverage", coverages[i]}});
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
    paths.back().replace_filename(text(level_stem(options), i, options.output.extension()));
  }
  paths.push_back(options.output);
  paths.back().replace_extension(".json");
  return paths;
}

Result<void> check_paths(const BuildCommand& options, std::size_t level_count) {
  LODESTONE_CHECK(check_format(options));
  for (const std::filesystem::path& path : output_paths(options, level_count))
    LODESTONE_CHECK(check_path(options, path));
  if (options.html) {
    LODESTONE_CHECK(check_page_path(options, level_count));
  }
  return options.report ? check_destination(*options.report) : Result<void>();
}

Result<void> make_mesh_file(const BuildCommand& options, const Scene& scene, BuildReport& report) {
  const std::size_t last = report.build.levels.size() - 1;
  LODESTONE_TRY(const Mesh surface, level_surface(scene, report.build.decoded, last));
  EncodedAsset file;
  LODESTONE_TRY(file.glb, write_mesh_bytes(surface, "level." + output_extension(options.output, options.format)));
  report.build.levels[last].bytes = file.layout.total_bytes = file.glb.size();
  report.build.files.assign(1, std::move(file));
  return {};
}

void list_files(const BuildCommand& options, BuildReport& report) {
  const std::vector<EncodedAsset>& assets = report.build.files;
  const std::vector<std::filesystem::path> paths = output_paths(options, assets.size());
  for (std::size_t i = 0; i < assets.size(); ++i) {
    report.files.push_back({paths[i].string(), assets[i].layout.total_bytes});
    report.output_bytes += assets[i].layout.total_bytes;
  }
}

std::vector<std::string> leftover_levels(const BuildCommand& options, const BuildReport& report) {
  if (!has_file_per_level(options)) return {};
  std::set<std::string> written;
  for (const BuildReport::OutputFile& file : report.files)
    written.insert(std::filesystem::path(file.path).filename().string());
  const std::filesystem::path parent = options.output.parent_path();
  std::set<std::string> left;  // sorted
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(parent.empty() ? "." : parent, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_level_name(name, level_stem(options)) && !written.contains(name))
      left.insert(quoted(std::string_view(name)));
  }
  if (left.empty()) return {};
  std::string list;
  for (const std::string& name : left) list += (list.empty() ? "" : ", ") + name;
  return {list + (left.size() == 1 ? " is" : " are") + " left from an earlier run: no level of this one"};
}

Result<void> write_outputs(const BuildCommand& options, const BuildReport& report, const std::string& page) {
  const std::vector<EncodedAsset>& assets = report.build.files;
  const std::vector<std::filesystem::path> paths = output_paths(options, assets.size());
  StagedFiles files;
  const InputFiles input{options.input, report.input.files};
  for (std::size_t i = 0; i < assets.size(); ++i) {
    LODESTONE_CHECK(add_asset(assets[i], paths[i], input, files));
  }
  if (has_file_per_level(options)) {
    LODESTONE_CHECK(files.add(paths.back(), json_text(index_json(report))));
  }
  if (options.html) {
    LODESTONE_CHECK(files.add(*options.html, page));
  }
  if (options.report) {
    LODESTONE_CHECK(files.add(*options.report, json_text(report_json(report))));
  }
  return files.commit();
}

}  // namespace lodestone::tool

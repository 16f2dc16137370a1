#include "build_options.h"

#include <array>
#include <map>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/file.h>

#include "build_settings.h"
#include "error_size.h"
#include "file_words.h"
#include "messages.h"

namespace lodestone::tool {
namespace {

constexpr int kDefaultLevelCount = 5;
constexpr double kDefaultRatio = 0.5;
constexpr double kShownRatio =
    0.03;  // Of what a viewer without the extension shows: it adds a twentieth to the stream.

Metric metric_of(const std::string& name) {
  if (name == "gaussian") return Metric::Gaussian;
  if (name == "mean") return Metric::Mean;
  if (name == "principal") return Metric::Principal;
  return Metric::Hybrid;
}

Result<void> set_weight(const std::string& text, AttributeWeights& weights) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::map<std::string, double*> known = {{"normal", &weights.normal},
                                                {"texcoord", &weights.texcoord},
                                                {"color", &weights.color},
                                                {"skin", &weights.skin},
                                                {"target", &weights.target}};
  const auto found = known.find(name);
  if (found == known.end())
    return fail(ErrorCode::InvalidArgument,
                "--weight: " + quoted(std::string_view(name)) + " is not normal, texcoord, color, skin or target");
  const Result<double> factor = parse_number(equals == text.npos ? "" : text.substr(equals + 1));
  if (!factor || !(*factor >= 0))
    return fail(ErrorCode::InvalidArgument,
                "--weight: " + quoted(std::string_view(text)) + " does not end in a factor of 0 or more");
  *found->second = *factor;
  return {};
}

Json weights_json(const AttributeWeights& weights) {
  return {{"normal", weights.normal},
          {"texcoord", weights.texcoord},
          {"color", weights.color},
          {"skin", weights.skin},
          {"target", weights.target}};
}

}  // namespace

bool has_file_per_level(const BuildCommand& options) { return options.profile == "files"; }

bool shows_one_level(const BuildCommand& options) { return options.profile == "stream"; }

bool has_one_level(const BuildCommand& options) { return options.profile == "level"; }

bool writes_mesh_file(const BuildCommand& command) {
  const std::string extension = output_extension(command.output, command.format);
  return has_one_level(command) && (extension == "obj" || extension == "ply");
}

bool writes_stream_file(const BuildCommand& command) {
  return !has_one_level(command) && output_extension(command.output, command.format) == "lods";
}

namespace {

/// An option that a kind of output has no use for.
struct IdleOption {
  bool is_given;
  const char* name;
  const char* why;
};

Result<void> check_idle(std::span<const IdleOption> options) {
  for (const IdleOption& option : options)
    if (option.is_given) return fail(ErrorCode::InvalidArgument, detail::text(option.name, ": ", option.why));
  return {};
}

/// Options of files with levels, which a stream has none of, or that streams have nothing for.
Result<void> check_stream_file(const BuildCommand& command) {
  return check_idle(
      std::array{IdleOption{command.per_mesh, "--per-mesh", "a .lods is one mesh"},
                 IdleOption{command.profile != "msft-lod", "--profile", "a .lods is one file"},
                 IdleOption{command.no_stream, "--no-stream", "a .lods is a stream"},
                 IdleOption{command.compression != "draco", "--compress", "a .lods is compressed in its own way"},
                 IdleOption{command.grid_step.has_value(), "--grid-step", "a .lods does not have it"}});
}

/// Options of how a glTF is stored.
Result<void> check_mesh_file(const BuildCommand& command) {
  constexpr const char* kWhy = "a .obj or .ply keeps positions as they are";
  return check_idle(std::array{IdleOption{command.compression != "draco", "--compress", kWhy},
                               IdleOption{command.position_bits.has_value(), "--qp", kWhy},
                               IdleOption{command.grid_step.has_value(), "--grid-step", kWhy}});
}

/// A stream has every level; only reports and pages have some.
Result<void> check_stream_levels(const BuildCommand& options, const std::vector<LevelTarget>& given) {
  if (options.report || options.html || (given.empty() && !options.level_count)) return {};
  return fail(ErrorCode::InvalidArgument,
              detail::text(options.level_count ? "--levels" : "--ratio, --faces, --error and --epsilon",
                           ": a .lods has every level; with --report or --html they say which are measured"));
}

/// Compact streams have bits that not every file has.
Result<void> check_stream_bits(const BuildCommand& command) {
  const auto& bits = command.position_bits;
  if (!bits || (*bits >= kLeastGridBits && *bits <= kMostGridBits)) return {};
  return fail(ErrorCode::InvalidArgument, detail::text("--qp: a stream's positions have ", kLeastGridBits, " to ",
                                                       kMostGridBits, " bits, not ", *bits));
}

Result<std::vector<LevelTarget>> requested_levels(const BuildCommand& options, const std::vector<LevelTarget>& given) {
  if (has_one_level(options)) {
    if (given.size() != 1)
      return fail(ErrorCode::InvalidArgument, "give one value with one of --ratio, --faces, --error, --epsilon");
    return given;
  }
  if (shows_one_level(options)) {
    if (given.size() > 1 || options.level_count)
      return fail(ErrorCode::InvalidArgument, "--profile stream shows one level: give one target, and no --levels");
    if (options.no_stream) return fail(ErrorCode::InvalidArgument, "--no-stream: --profile stream is a stream");
    return given.empty() ? ratio_targets(kShownRatio, 1) : given;
  }
  if (writes_stream_file(options)) {
    LODESTONE_CHECK(check_stream_levels(options, given));
    if (!options.report && !options.html) return given;
  }
  const bool by_ratio = given.empty() || options.targets.is_one_ratio();
  if (!by_ratio && options.level_count) {
    return fail(ErrorCode::InvalidArgument, "--levels goes with one --ratio; a list has one level for each entry");
  }
  if (!by_ratio) return given;
  const double ratio = given.empty() ? kDefaultRatio : given.front().value;
  std::vector<LevelTarget> levels = ratio_targets(ratio, options.level_count.value_or(kDefaultLevelCount) - 1);
  for (LevelTarget& level : levels) level.is_wish = given.empty();
  return levels;
}

Result<SimplifyOptions> simplify_options(const BuildCommand& options) {
  SimplifyOptions simplify;
  for (const std::string& text : options.weights) LODESTONE_CHECK(set_weight(text, simplify.weights));
  simplify.lock_border = options.lock_border;
  simplify.vanish = options.vanish;
  if (options.crease_angle) simplify.crease_angle = *options.crease_angle * std::numbers::pi / 180;
  simplify.metric = metric_of(options.metric);
  simplify.normalisation = options.normalisation == "density" ? Normalisation::Density : Normalisation::Integral;
  simplify.reference = options.reference == "current" ? Reference::Current : Reference::Original;
  return simplify;
}

Compression compression_of(const std::string& name) {
  for (const Compression compression : {Compression::Draco, Compression::Meshopt})
    if (name == name_of(compression)) return compression;
  return Compression::None;
}

Result<AssetOptions> asset_options(const BuildCommand& options) {
  AssetOptions asset;
  asset.compression = writes_mesh_file(options) ? Compression::None : compression_of(options.compression);
  asset.position_bits = options.position_bits;
  if (!options.grid_step) return asset;
  if (asset.compression == Compression::Meshopt && options.grid_origin != BuildCommand{}.grid_origin)
    return fail(ErrorCode::InvalidArgument,
                "--grid-origin does not go with --compress meshopt: its grids count from 0");
  const auto origin = [&](std::size_t i) { return static_cast<float>(options.grid_origin[i]); };
  asset.position_grid = {{origin(0), origin(1), origin(2)}, static_cast<float>(*options.grid_step)};
  return asset;
}

}  // namespace

bool writes_stream(const BuildCommand& options) {
  return !options.no_stream && !has_file_per_level(options) && !has_one_level(options);
}

Result<BuildOptions> build_options(const BuildCommand& command) {
  if (writes_stream_file(command)) LODESTONE_CHECK(check_stream_file(command));
  if (writes_mesh_file(command)) LODESTONE_CHECK(check_mesh_file(command));
  if (writes_stream_file(command) || shows_one_level(command)) LODESTONE_CHECK(check_stream_bits(command));
  BuildOptions options;
  options.effort = command.effort;
  LODESTONE_TRY(const TargetOptions::Parsed given, command.targets.parse());
  LODESTONE_TRY(options.targets, requested_levels(command, given.targets));
  options.limit = given.limit;
  LODESTONE_TRY(options.simplify, simplify_options(command));
  if (command.settings) {
    LODESTONE_TRY(options.importance, read_settings(*command.settings));
  }
  options.importance.attribute = command.importance;
  options.scope = command.per_mesh ? TargetScope::Mesh : TargetScope::Scene;
  options.placement = command.placement == "subset" ? Placement::Subset : Placement::Optimised;
  if (has_file_per_level(command)) options.layout = FileLayout::FilePerLevel;
  if (has_one_level(command)) options.layout = FileLayout::OneLevel;
  if (shows_one_level(command)) options.layout = FileLayout::Refined;
  if (writes_stream_file(command)) options.layout = FileLayout::StreamAlone;
  options.stream = !command.no_stream;
  options.lossless = command.lossless;
  if (command.stream_coding)
    options.stream_coding = *command.stream_coding == "fast" ? CompactCoding::Fast : CompactCoding::Small;
  options.strict = command.strict;
  options.keep_levels = command.html.has_value() || writes_mesh_file(command);
  LODESTONE_TRY(options.storage, asset_options(command));
  if (extension_of(command.output) == "gltf") options.storage.gltf_name = command.output.stem().string();
  return options;
}

Json settings_json(const BuildCommand& options, const BuildOptions& understood) {
  const std::optional<LevelTarget>& limit = understood.limit;
  const bool has_own_form = writes_stream_file(options) || writes_mesh_file(options);
  Json json = {{"effort", options.effort},
               {"metric", options.metric},
               {"normalise", options.normalisation},
               {"reference", options.reference},
               {"levels", understood.targets.size() + 1},
               {"per_mesh", options.per_mesh},
               {"error_limit", limit ? Json{{limit->relative ? "error_ratio" : "error", limit->value}} : Json(nullptr)},
               {"placement", options.placement},
               {"profile", writes_stream_file(options) ? "lods" : options.profile},
               {"lock_border", options.lock_border},
               {"vanish", options.vanish},
               {"crease_angle_degrees", options.crease_angle ? Json(*options.crease_angle) : Json(nullptr)},
               {"weights", weights_json(understood.simplify.weights)},
               {"importance", options.importance},
               {"settings", options.settings ? Json(options.settings->string()) : Json(nullptr)},
               {"stream", writes_stream(options)},
               {"lossless", options.lossless},
               {"stream_coding", stream_coding_of(understood) == CompactCoding::Fast ? "fast" : "small"},
               {"compression", has_own_form ? Json(nullptr) : Json(options.compression)}};
  const bool has_grid = compression_of(options.compression) != Compression::None;
  const bool has_bits = has_grid && options.position_bits;
  json["position_bits"] = has_bits ? Json(*options.position_bits) : Json(nullptr);
  json["position_grid"] = nullptr;
  if (has_grid && options.grid_step)
    json["position_grid"] = {{"step", *options.grid_step}, {"origin", options.grid_origin}};
  return json;
}

}  // namespace lodestone::tool

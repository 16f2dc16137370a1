#include "build_options.h"

#include <algorithm>
#include <cmath>

namespace lodestone::tool {
namespace {

constexpr int kDefaultLevelCount = 5;
constexpr double kDefaultRatio = 0.5;

Metric metric_of(const std::string& name) {
  if (name == "gaussian") return Metric::Gaussian;
  if (name == "mean") return Metric::Mean;
  if (name == "principal") return Metric::Principal;
  return Metric::Hybrid;
}

}  // namespace

bool has_file_per_level(const BuildCommand& options) { return options.profile == "files"; }

Result<std::vector<LevelTarget>> requested_levels(const BuildCommand& options) {
  Result<std::vector<LevelTarget>> given = options.targets.parse();
  if (!given) return given;
  const bool by_ratio = given->empty() || options.targets.ratio;
  if (!by_ratio && options.level_count) {
    return fail(ErrorCode::InvalidArgument, "--levels goes with --ratio; a list has one level for each entry");
  }
  if (!by_ratio) return given;
  const double ratio = given->empty() ? kDefaultRatio : given->front().value;
  std::vector<LevelTarget> levels;
  for (int i = 1; i < options.level_count.value_or(kDefaultLevelCount); ++i) {
    levels.push_back({TargetKind::Faces, std::pow(ratio, i), true});
  }
  return levels;
}

void sort_finest_first(std::vector<LevelTarget>& targets, const FullSize& scene) {
  std::stable_sort(targets.begin(), targets.end(), [&](const LevelTarget& a, const LevelTarget& b) {
    const double first = resolve(a, scene).value, second = resolve(b, scene).value;
    return a.kind == TargetKind::Faces ? first > second : first < second;
  });
}

SimplifyOptions metric_options(const BuildCommand& options) {
  SimplifyOptions simplify;
  simplify.metric = metric_of(options.metric);
  simplify.normalisation = options.normalisation == "density" ? Normalisation::Density : Normalisation::Integral;
  simplify.reference = options.reference == "current" ? Reference::Current : Reference::Original;
  return simplify;
}

Json settings_json(const BuildCommand& options, std::size_t level_count) {
  Json json = {{"metric", options.metric},
               {"normalise", options.normalisation},
               {"reference", options.reference},
               {"levels", level_count},
               {"per_mesh", options.per_mesh},
               {"profile", options.profile},
               {"stream", !options.no_stream && !has_file_per_level(options)},
               {"draco", !options.no_draco}};
  json["position_bits"] = options.no_draco ? Json(nullptr) : Json(options.position_bits);
  return json;
}

}  // namespace lodestone::tool

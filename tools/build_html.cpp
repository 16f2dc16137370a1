#include "build_html.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <lodestone/io/read_mesh.h>

#include "html_report.h"

namespace lodestone::tool {
namespace {

constexpr int kBoundCount = 160;
constexpr double kBoundRange = 1e6;  // from the largest bound that is shown to the smallest

/// Returns a level as the scene shows it: the meshes in their places, as one.
Result<Mesh> world_level(const Scene& scene, std::span<const LeveledMesh> levels, std::size_t level) {
  AssetOptions options;
  options.draco = false;
  const Result<EncodedAsset> asset = encode_scene_level(scene, levels, level, options);
  if (!asset) return tl::unexpected(asset.error());
  Result<MeshFile> flat = read_mesh_bytes(asset->glb, "glb");
  if (!flat) return tl::unexpected(flat.error());
  return std::move(flat->mesh);
}

/// Returns what the streams promise: pairs of drawn faces and the world error that they are proved to lie within.
Json bounds_json(std::span<const ScenePart> parts) {
  std::vector<std::vector<Index>> faces;
  double largest = 0;
  for (const ScenePart& part : parts) {
    faces.push_back(face_counts(*part.mesh));
    for (const float deviation : part.mesh->deviation)
      if (std::isfinite(deviation)) largest = std::max(largest, deviation * part.scale);
  }
  Json json = Json::array();
  std::size_t last = 0;
  for (int i = 0; i < kBoundCount && largest > 0; ++i) {
    const double error = largest * std::pow(kBoundRange, -double(i) / (kBoundCount - 1));
    std::size_t drawn = 0;
    double bound = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Index position = position_for_deviation(*parts[k].mesh, error / parts[k].scale * (1 + 1e-9));
      drawn += faces[k][position] * parts[k].instance_count;
      bound = std::max(bound, parts[k].mesh->deviation[position] * parts[k].scale);
    }
    if (drawn != last && bound > 0) json.push_back({drawn, bound});
    last = drawn;
  }
  return json;
}

}  // namespace

Result<std::string> build_page(const BuildReport& report, const Scene& scene, std::span<const LeveledMesh> levels,
                               std::span<const ScenePart> streams) {
  HtmlReport page;
  page.title = "Levels of " + std::filesystem::path(report.input.path).filename().string();
  page.diagonal = report.input.box.diagonal();
  Json numbers = report_json(report);
  numbers.erase("timings_ms");
  numbers.erase("peak_memory_bytes");
  page.numbers = {{"kind", "build"}, {"report", std::move(numbers)}, {"bounds", bounds_json(streams)}};
  for (std::size_t i = 0; i < report.levels.size(); ++i) {
    Result<Mesh> level = world_level(scene, levels, i);
    if (!level) return tl::unexpected(level.error());
    page.meshes.push_back(std::move(*level));
  }
  return html_page(page);
}

}  // namespace lodestone::tool

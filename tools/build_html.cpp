#include "build_html.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <lodestone/core/detail/try.h>

#include "html_report.h"

namespace lodestone::tool {
namespace {

constexpr int kBoundCount = 160;
constexpr double kBoundRange = 1e6;  // from the largest bound that is shown to the smallest

/// Returns what the streams promise: pairs of drawn faces and the world error that they are proved to lie within.
Json bounds_json(const Scene& scene, const std::vector<SimplifyResult>& streams) {
  std::vector<std::vector<Index>> faces;
  double largest = 0;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    faces.push_back(face_counts(streams[i].mesh));
    for (const float deviation : streams[i].mesh.deviation)
      if (std::isfinite(deviation)) largest = std::max(largest, deviation * scene.meshes()[i].scale);
  }
  Json json = Json::array();
  std::size_t last = 0;
  for (int i = 0; i < kBoundCount && largest > 0; ++i) {
    const double error = largest * std::pow(kBoundRange, -double(i) / (kBoundCount - 1));
    std::size_t drawn = 0;
    double bound = 0;
    for (std::size_t k = 0; k < streams.size(); ++k) {
      const SceneMesh& mesh = scene.meshes()[k];
      const Index position = position_for_deviation(streams[k].mesh, error / mesh.scale * (1 + 1e-9));
      drawn += faces[k][position] * mesh.instance_count;
      bound = std::max(bound, streams[k].mesh.deviation[position] * mesh.scale);
    }
    if (drawn != last && bound > 0) json.push_back({drawn, bound});
    last = drawn;
  }
  return json;
}

}  // namespace

Result<std::string> build_page(const BuildReport& report, const Scene& scene, bool with_bounds) {
  HtmlReport page;
  page.title = "Levels of " + std::filesystem::path(report.input.path).filename().string();
  page.diagonal = report.input.box.diagonal();
  Json numbers = report_json(report);
  numbers.erase("timings_ms");
  numbers.erase("peak_memory_bytes");
  page.numbers = {{"kind", "build"},
                  {"report", std::move(numbers)},
                  {"bounds", with_bounds ? bounds_json(scene, report.build.simplified) : Json::array()}};
  for (std::size_t i = 0; i < report.build.levels.size(); ++i) {
    LODESTONE_TRY(Mesh level, level_surface(scene, report.build.decoded, i));
    page.meshes.push_back(std::move(level));
  }
  return html_page(page);
}

}  // namespace lodestone::tool

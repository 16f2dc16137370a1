#include "error_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::tool {
namespace {

constexpr std::size_t kSampleCount = 50'000;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Returns the distances at points at equal steps of the area.
std::vector<double> sampled_errors(const Mesh& mesh, const SurfaceIndex& surface) {
  const double step = surface_area(mesh) / kSampleCount;
  std::vector<double> errors;
  double due = 0.5 * step;  // what of the area is left before the next point
  Index hint = kNoIndex;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    for (due -= 0.5 * length(area_vector(mesh, face)); due < 0 && errors.size() < kSampleCount; due += step) {
      const SurfaceIndex::Hit hit = surface.nearest(point_on_face(mesh, face, errors.size()), kFar, hint);
      hint = hit.face;
      errors.push_back(hit.distance);
    }
  }
  return errors;
}

double percentile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

std::size_t bin_of(double error, double maximum) {
  if (!(maximum > 0)) return 0;
  const auto bin = static_cast<std::size_t>(std::sqrt(error / maximum) * ErrorSpread::kBinCount);
  return std::min(bin, ErrorSpread::kBinCount - 1);
}

}  // namespace

std::vector<float> vertex_errors(const Mesh& mesh, const SurfaceIndex& surface) {
  std::vector<float> errors(mesh.vertex_count());
  Index hint = kNoIndex;
  for (std::size_t v = 0; v < errors.size(); ++v) {
    const SurfaceIndex::Hit hit = surface.nearest(Vec3(mesh.positions[v]), kFar, hint);
    hint = hit.face;
    errors[v] = static_cast<float>(hit.distance);
  }
  return errors;
}

ErrorSpread measure_spread(const Mesh& mesh, const SurfaceIndex& surface, double at_least) {
  std::vector<double> errors = sampled_errors(mesh, surface);
  if (errors.empty()) errors.push_back(at_least);  // a mesh without area
  std::sort(errors.begin(), errors.end());
  ErrorSpread spread{std::max(errors.back(), at_least),
                     percentile(errors, 0.5),
                     percentile(errors, 0.9),
                     percentile(errors, 0.99),
                     {}};
  const double share = 1 / static_cast<double>(errors.size());
  for (const double error : errors) spread.bins[bin_of(error, spread.maximum)] += share;
  return spread;
}

}  // namespace lodestone::tool

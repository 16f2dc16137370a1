#include "simplify/simplify_state.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

#include <lodestone/core/parallel.h>

#include "simplify/angles.h"

namespace lodestone::detail {
namespace {

/// 2π less the angles at a vertex, π at a border; 0 where it has no faces.
double gaussian_curvature(const SimplifyState& state, Index vertex) {
  const Connectivity& mesh = state.connectivity;
  const Index start = mesh.corner_at(vertex);
  if (start == kNoIndex) return 0;
  constexpr std::size_t kMost = 16;
  std::array<double, kMost> cosine, sine, angle;
  std::size_t count = 0;
  double sum = 0;
  const auto add_up = [&] {
    angles(count, cosine.data(), sine.data(), angle.data());
    sum = std::accumulate(angle.begin(), angle.begin() + static_cast<std::ptrdiff_t>(count), sum);
    count = 0;
  };
  const Vec3 center(state.mesh.positions[vertex]);
  Index corner = start;
  do {
    const Vec3 a = Vec3(state.mesh.positions[mesh.vertex(next_corner(corner))]) - center;
    const Vec3 b = Vec3(state.mesh.positions[mesh.vertex(previous_corner(corner))]) - center;
    cosine[count] = dot(a, b);
    sine[count] = length(cross(a, b));
    if (++count == kMost) add_up();
    corner = mesh.swing_left(corner);
  } while (corner != kNoIndex && corner != start);
  add_up();
  return (corner == kNoIndex ? 1 : 2) * std::numbers::pi - sum;
}

}  // namespace

double metric_curvature(const SimplifyOptions& options, const VertexCurvature& curvature) {
  double value = 0;
  switch (options.metric) {
    case Metric::Hybrid:
    case Metric::Gaussian:
      value = curvature.gaussian;
      break;
    case Metric::Mean:
      value = curvature.mean;
      break;
    case Metric::Principal:
      value = principal_curvature(curvature);
      break;
  }
  if (options.normalisation == Normalisation::Integral) return value;
  return curvature.area > 0 ? value / curvature.area : 0;
}

void gather_curvature(SimplifyState& state, const SimplifyOptions& options) {
  const std::size_t count = state.mesh.vertex_count();
  tracks_gaussian_curvature(options) ? state.gaussian.resize(count) : state.curvature.resize(count);
  state.original_curvature.resize(count);
  constexpr std::size_t kChunk = 4096;
  for_each_chunk(count, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      update_curvature(state, options, static_cast<Index>(v));
      state.original_curvature[v] =
          static_cast<float>(metric_curvature(options, state.curvature_at(static_cast<Index>(v))));
    }
  });
}

void update_curvature(SimplifyState& state, const SimplifyOptions& options, Index vertex) {
  if (tracks_gaussian_curvature(options)) {
    state.gaussian[vertex] = gaussian_curvature(state, vertex);
  } else {
    state.curvature[vertex] = vertex_curvature(state.mesh, state.connectivity, vertex);
  }
}

void keep_curvature(SimplifyState& state, std::span<const RemovalRecord> records, std::span<const double> gaussian) {
  if (gaussian.empty()) return;
  const std::vector<Index>& polygon = records.front().sectors.front().polygon;
  for (std::size_t i = 0; i < gaussian.size(); ++i)
    state.gaussian[state.connectivity.vertex_of_wedge(polygon[i])] = gaussian[i];
}

void carry_lines(SimplifyState& state, const RemovalRecord& record) {
  if (record.sectors.front().shape == SectorShape::Closed) return;
  std::vector<Index> others;
  for (const SectorPatch& sector : record.sectors)
    others.push_back(state.connectivity.vertex_of_wedge(sector.polygon.front()));
  const SectorPatch& last = record.sectors.back();
  if (record.open_star) others.push_back(state.connectivity.vertex_of_wedge(last.polygon[last.face_count()]));
  const Index target = record.target != kNoIndex ? record.target : others.front();
  others.erase(std::remove(others.begin(), others.end(), target), others.end());
  state.lines.collapse(record.vertex, target, others);
}

}  // namespace lodestone::detail

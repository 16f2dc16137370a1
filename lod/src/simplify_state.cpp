#include "simplify_state.h"

#include <limits>

#include "point_triangle.h"

namespace lodestone::detail {
namespace {

/// Takes all points off a sector's fine faces.
std::vector<Index> take_points(CarriedPoints& points, const SectorPatch& sector) {
  std::vector<Index> taken;
  for (const Index face : sector.faces) {
    for (Index p = points.first(face); p != kNoIndex; p = points.next(p)) taken.push_back(p);
    points.clear(face);
  }
  return taken;
}

/// The faces that take over from a sector's fine ones: its coarse faces, or the one beyond where nothing is left.
std::vector<Index> heirs(const SectorPatch& sector) {
  if (sector.polygon.size() > 2)
    return {sector.faces.begin(), sector.faces.begin() + static_cast<std::ptrdiff_t>(sector.triangles.size())};
  if (sector.lone_outer == kNoIndex) return {};
  return {face_of_corner(sector.lone_outer)};
}

void give_points(SimplifyState& state, const std::vector<Index>& taken, const std::vector<Index>& faces,
                 const Vec3& origin) {
  PointBatch batch;
  for (const Index p : taken) batch.add(state.points.position(p) - origin);
  std::vector<float> distance(taken.size());
  std::vector<float> nearest(taken.size(), std::numeric_limits<float>::infinity());
  std::vector<Index> heir(taken.size(), faces.empty() ? kNoIndex : faces.front());
  for (const Index face : faces) {
    const auto corner = [&](Index i) {
      return Vec3(state.mesh.positions[state.connectivity.vertex(3 * face + i)]) - origin;
    };
    squared_distances(batch, {corner(0), corner(1), corner(2)}, distance.data());
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (distance[i] < nearest[i]) nearest[i] = distance[i], heir[i] = face;
  }
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (heir[i] != kNoIndex) state.points.add(heir[i], taken[i]);
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

void carry_memory(SimplifyState& state, const RemovalRecord& record) {
  const Vec3 center(state.mesh.positions[record.vertex]);
  for (const SectorPatch& sector : record.sectors) {
    std::vector<Index> taken = take_points(state.points, sector);
    if (&sector == &record.sectors.front()) taken.push_back(record.vertex);
    give_points(state, taken, heirs(sector), center);
  }
  const SectorPatch& first = record.sectors.front();
  if (first.closed) return;
  state.lines.merge(state.connectivity.vertex_of_wedge(first.polygon.front()), record.vertex,
                    state.connectivity.vertex_of_wedge(first.polygon.back()));
}

}  // namespace lodestone::detail

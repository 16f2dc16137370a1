#include "simplify/simplify_state.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <numeric>

#include <lodestone/core/parallel.h>

#include "distance/point_triangle.h"
#include "simplify/angles.h"

namespace lodestone::detail {
namespace {

// Enough to tell a face's distance from the surface it stands for; more costs time and gains nothing measurable.
constexpr std::size_t kMaxPointsOfFace = 5;

/// Takes all points off a sector's fine faces.
std::vector<Index> take_points(CarriedPoints& points, const SectorPatch& sector) {
  std::vector<Index> taken;
  for (const Index face : sector.faces) {
    for (Index p = points.first(face); p != kNoIndex; p = points[p].next) taken.push_back(p);
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

/// The same for a sector of which nothing is left and nothing lies beyond: the faces of all sectors.
std::vector<Index> heirs_of_all(const RemovalRecord& record) {
  std::vector<Index> faces;
  for (const SectorPatch& sector : record.sectors) {
    const std::vector<Index> some = heirs(sector);
    faces.insert(faces.end(), some.begin(), some.end());
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

/// A face that a point is given to, and how far it is from there.
struct Heir {
  Index face = kNoIndex;
  float squared_distance = std::numeric_limits<float>::infinity();
};

/// Returns the heir nearest to each point.
std::vector<Heir> nearest_heirs(const SimplifyState& state, const std::vector<Index>& taken,
                                const std::vector<Index>& faces, const Vec3& origin) {
  PointBatch batch;
  for (const Index p : taken) batch.add(Vec3(state.points[p].position) - origin);
  std::vector<float> distance(batch.padded_size());
  std::vector<Heir> heir(taken.size());
  for (const Index face : faces) {
    const auto corner = [&](Index i) {
      return Vec3(state.mesh.positions[state.connectivity.vertex(3 * face + i)]) - origin;
    };
    squared_distances(batch, {corner(0), corner(1), corner(2)}, distance.data());
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (distance[i] < heir[i].squared_distance) heir[i] = {face, distance[i]};
  }
  return heir;
}

/// Keeps every n-th point of a crowded face, with the weight of all.
void thin(CarriedPoints& points, std::vector<Index>& members) {
  if (members.size() <= kMaxPointsOfFace) return;
  const auto weight_of = [&](float sum, Index p) { return sum + points[p].weight; };
  const float before = std::accumulate(members.begin(), members.end(), 0.0F, weight_of);
  for (std::size_t i = 0; i < kMaxPointsOfFace; ++i) members[i] = members[i * members.size() / kMaxPointsOfFace];
  members.resize(kMaxPointsOfFace);
  const float after = std::accumulate(members.begin(), members.end(), 0.0F, weight_of);
  for (const Index p : members) points[p].weight *= before / after;
}

void give_points(SimplifyState& state, const std::vector<Index>& taken, const std::vector<Index>& faces,
                 const Vec3& origin) {
  const std::vector<Heir> heir = nearest_heirs(state, taken, faces, origin);
  std::vector<Index> members;
  for (const Index face : faces) {
    // What the heir holds already stays in the count: the face beyond an ear keeps its own points.
    members.clear();
    for (Index p = state.points.first(face); p != kNoIndex; p = state.points[p].next) members.push_back(p);
    state.points.clear(face);
    for (std::size_t i = 0; i < taken.size(); ++i) {
      if (heir[i].face != face) continue;
      members.push_back(taken[i]);
      state.points[taken[i]].squared_distance = heir[i].squared_distance;
    }
    thin(state.points, members);
    for (const Index p : members) state.points.add(face, p);
  }
}

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
  state.curvature.resize(count);
  state.original_curvature.resize(count);
  constexpr std::size_t kChunk = 4096;
  for_each_chunk(count, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      update_curvature(state, options, static_cast<Index>(v));
      state.original_curvature[v] = static_cast<float>(metric_curvature(options, state.curvature[v]));
    }
  });
}

void update_curvature(SimplifyState& state, const SimplifyOptions& options, Index vertex) {
  if (tracks_gaussian_curvature(options)) {
    state.curvature[vertex].gaussian = gaussian_curvature(state, vertex);
  } else {
    state.curvature[vertex] = vertex_curvature(state.mesh, state.connectivity, vertex);
  }
}

void keep_curvature(SimplifyState& state, std::span<const RemovalRecord> records, std::span<const double> gaussian) {
  if (gaussian.empty()) return;
  const std::vector<Index>& polygon = records.front().sectors.front().polygon;
  for (std::size_t i = 0; i < gaussian.size(); ++i)
    state.curvature[state.connectivity.vertex_of_wedge(polygon[i])].gaussian = gaussian[i];
}

void carry_points(SimplifyState& state, const RemovalRecord& record) {
  const Vec3 center(state.mesh.positions[record.vertex]);
  for (const SectorPatch& sector : record.sectors) {
    std::vector<Index> taken = take_points(state.points, sector);
    if (&sector == &record.sectors.front()) taken.push_back(record.vertex);
    std::vector<Index> faces = heirs(sector);
    if (faces.empty()) faces = heirs_of_all(record);
    give_points(state, taken, faces, center);
  }
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

#include "fit/fit_samples.h"

#include <algorithm>

#include "fit/constrained_edges.h"

namespace lodestone::detail {

SurfaceSamples::SurfaceSamples(const Mesh& original, std::size_t most) {
  // Cubic rules of a triangle: middle, corners, and the edges' middles where there is room for so many.
  const bool use_edges = 3 * original.face_count() <= most;
  const double middle_share = use_edges ? 27.0 / 60 : 45.0 / 60;
  const double corner_share = use_edges ? 3.0 / 60 : 5.0 / 60;
  const double edge_share = 8.0 / 60;
  std::vector<double> vertex_area(original.vertex_count(), 0);
  std::vector<SurfaceSample> all;
  for (Index f = 0; f < original.face_count(); ++f) {
    const Vec3 a = original.corner_position(3 * f);
    const Vec3 b = original.corner_position(3 * f + 1);
    const Vec3 c = original.corner_position(3 * f + 2);
    const double area = 0.5 * length(area_vector(original, f));
    all.push_back({(a + b + c) * (1.0 / 3), middle_share * area});
    for (Index k = 0; k < 3; ++k) vertex_area[original.corner_vertex(3 * f + k)] += corner_share * area;
    if (!use_edges) continue;
    for (const Vec3& middle : {(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5}) all.push_back({middle, edge_share * area});
  }
  for (Index v = 0; v < original.vertex_count(); ++v)
    if (vertex_area[v] > 0) all.push_back({Vec3(original.positions[v]), vertex_area[v]});
  const std::size_t step = std::max<std::size_t>(1, all.size() / std::max<std::size_t>(1, most));
  for (std::size_t i = 0; i < all.size(); i += step) samples_.push_back(all[i]);
}

LineSamples::LineSamples(const Mesh& original) {
  for (const MeshEdge& edge : list_edges(original)) {
    if (!edge.constrained) continue;
    const Vec3 a(original.positions[edge.vertices[0]]);
    const Vec3 b(original.positions[edge.vertices[1]]);
    const double share = length(b - a) / 2;
    samples_.push_back({a * 0.75 + b * 0.25, share});
    samples_.push_back({a * 0.25 + b * 0.75, share});
  }
}

}  // namespace lodestone::detail

#include "fit/fit_samples.h"

#include <algorithm>
#include <utility>

#include <lodestone/core/detail/edges.h>

#include "fit/constrained_edges.h"

namespace lodestone::detail {
namespace {

/// The area of the faces at each edge, by the corner at which the first of them, in the order given, begins it; 0 at
/// all other corners.
std::vector<double> areas_at_edges(const Mesh& mesh, std::span<const Index> face_order, std::span<const double> area) {
  std::vector<Index> place(mesh.face_count());
  for (Index i = 0; i < face_order.size(); ++i) place[face_order[i]] = i;
  std::vector<double> at(mesh.corner_wedge.size(), 0);
  for_each_edge(sorted_edges(mesh), [&](Edge edge) {
    const auto earlier = [&](const HalfEdge& a, const HalfEdge& b) {
      return place[face_of_corner(a.corner)] < place[face_of_corner(b.corner)];
    };
    double& sum = at[std::min_element(edge.begin(), edge.end(), earlier)->corner];
    for (const HalfEdge& half : edge) sum += area[face_of_corner(half.corner)];
  });
  return at;
}

}  // namespace

SurfaceSamples::SurfaceSamples(const Mesh& original, std::span<const Index> face_order, std::size_t most) {
  // Cubic rules of a triangle: middle, corners, and the edges' middles where there is room for so many.
  const bool use_edges = 3 * original.face_count() <= most;
  const double middle_share = use_edges ? 27.0 / 60 : 45.0 / 60;
  const double corner_share = use_edges ? 3.0 / 60 : 5.0 / 60;
  const double edge_share = use_edges ? 8.0 / 60 : 0;
  std::vector<double> area(original.face_count());
  std::vector<double> at_vertex(original.vertex_count(), 0);
  for (Index f = 0; f < original.face_count(); ++f) {
    area[f] = 0.5 * length(area_vector(original, f));
    for (Index k = 0; k < 3; ++k) at_vertex[original.corner_vertex(3 * f + k)] += corner_share * area[f];
  }
  std::vector<double> at_edge = use_edges ? areas_at_edges(original, face_order, area) : std::vector<double>();
  std::vector<SurfaceSample> all;
  all.reserve(original.face_count() + original.vertex_count() + (use_edges ? at_edge.size() / 2 : 0));
  for (const Index f : face_order) {
    const std::array<Vec3, 3> p{original.corner_position(3 * f), original.corner_position(3 * f + 1),
                                original.corner_position(3 * f + 2)};
    all.push_back({(p[0] + p[1] + p[2]) * (1.0 / 3), middle_share * area[f], original.corner_vertex(3 * f)});
    for (Index k = 0; k < 3; ++k) {
      const Index corner = 3 * f + k;
      if (use_edges && at_edge[corner] > 0)
        all.push_back({(p[k] + p[(k + 1) % 3]) * 0.5, edge_share * at_edge[corner], original.corner_vertex(corner)});
      const Index vertex = original.corner_vertex(corner);
      double& left = at_vertex[vertex];  // each vertex once, with the first of its faces
      if (left > 0) all.push_back({p[k], left, vertex});
      left = 0;
    }
  }
  const std::size_t step = std::max<std::size_t>(1, all.size() / std::max<std::size_t>(1, most));
  if (step > 1) {
    for (std::size_t i = 0; i * step < all.size(); ++i) all[i] = all[i * step];
    all.resize((all.size() + step - 1) / step);
    all.shrink_to_fit();
  }
  samples_ = std::move(all);
}

LineSamples::LineSamples(const Mesh& original, std::span<const MeshEdge> edges) {
  for (const MeshEdge& edge : edges) {
    if (!edge.constrained) continue;
    const Vec3 a(original.positions[edge.vertices[0]]);
    const Vec3 b(original.positions[edge.vertices[1]]);
    const double share = length(b - a) / 2;
    samples_.push_back({a * 0.75 + b * 0.25, share});
    samples_.push_back({a * 0.25 + b * 0.75, share});
  }
}

}  // namespace lodestone::detail

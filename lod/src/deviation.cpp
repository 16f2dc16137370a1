// Mean and root mean square by sampling as in P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on
// simplified surfaces", Computer Graphics Forum 17(2), 1998, but with samples that are always the same: they lie at
// equal steps of area, and within the faces by M. Roberts' quasirandom sequence R2 ("The unreasonable effectiveness of
// quasirandom sequences", 2018). The maximum is not left to the samples, see supremum.cpp.

#include <lodestone/lod/deviation.h>

#include <cmath>

#include "supremum.h"

namespace lodestone {
namespace {

using detail::Goal;
using detail::PatchBound;
using detail::SupremumSearch;
using detail::SurfaceBounds;

Vec3 area_vector(const Mesh& mesh, Index face) {
  const Vec3 a = mesh.corner_position(3 * face);
  return cross(mesh.corner_position(3 * face + 1) - a, mesh.corner_position(3 * face + 2) - a);
}

/// Points on a mesh, the same number for each unit of area.
class AreaSamples {
 public:
  AreaSamples(const Mesh& mesh, std::size_t count) : mesh_(mesh), count_(count), area_until_(mesh.face_count()) {
    double sum = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) area_until_[f] = sum += length(area_vector(mesh, f));
    if (sum > 0) return;
    for (Index f = 0; f < mesh.face_count(); ++f) area_until_[f] = f + 1;  // Nothing but lines and points: one each.
  }

  /// Calls `visit(point, face)` for each sample.
  template <class Visit>
  void for_each(const Visit& visit) const {
    Index face = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const double area = (static_cast<double>(k) + 0.5) / static_cast<double>(count_) * area_until_.back();
      while (face + 1 < area_until_.size() && area_until_[face] < area) ++face;
      visit(point_of(face, k), face);
    }
  }

 private:
  Vec3 point_of(Index face, std::size_t k) const {
    const double n = static_cast<double>(k);
    double u = std::fmod(0.5 + n * 0.7548776662466927, 1.0);
    double v = std::fmod(0.5 + n * 0.5698402909980532, 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return mesh_.corner_position(3 * face) * (1 - u - v) + mesh_.corner_position(3 * face + 1) * u +
           mesh_.corner_position(3 * face + 2) * v;
  }

  const Mesh& mesh_;
  std::size_t count_;
  std::vector<double> area_until_;  // Running sums: twice the area of the faces up to and with each.
};

/// Fills in mean and rms, and returns the mean angle between the normals at the samples and at their nearest points.
double measure_means(const Mesh& from, const Mesh& to, const SurfaceIndex& to_index, std::size_t sample_count,
                     OneSidedDeviation& result) {
  double sum = 0, squares = 0, angles = 0;
  Index hint = kNoIndex;
  AreaSamples(from, sample_count).for_each([&](const Vec3& point, Index face) {
    const SurfaceIndex::Hit hit = to_index.nearest(point, detail::kUnbounded, hint);
    hint = hit.face;
    sum += hit.distance;
    squares += hit.distance * hit.distance;
    angles += angle_between(area_vector(from, face), area_vector(to, hit.face));
  });
  const double count = static_cast<double>(std::max<std::size_t>(sample_count, 1));
  result.mean = sum / count;
  result.rms = std::sqrt(squares / count);
  result.sample_count = sample_count;
  return angles / count;
}

/// Narrows one direction's maximum on its own; leaves mean and rms as they are.
void narrow_maximum(const Mesh& from, const Mesh& to, const SurfaceIndex& to_index, const DeviationOptions& options,
                    Goal goal, OneSidedDeviation& result) {
  SurfaceBounds bounds(from, false);
  PatchBound to_patch(to);
  SupremumSearch search(from, to_index, to_patch, bounds);
  search.visit_vertices(goal);
  search.split_faces(goal, options.budget);
  const OneSidedDeviation narrowed = search.result();
  result.maximum = narrowed.maximum;
  result.maximum_bound = narrowed.maximum_bound;
}

/// The deviation where a mesh has no faces: the means are as the maximum.
Deviation deviation_of_empty(const Mesh& a, const Mesh& b) {
  Deviation result = detail::maximum_of_empty(a, b);
  result.forward.mean = result.forward.rms = result.forward.maximum;
  result.backward.mean = result.backward.rms = result.backward.maximum;
  return result;
}

}  // namespace

Deviation measure_deviation(const Mesh& a, const Mesh& b, const DeviationOptions& options) {
  if (a.face_count() == 0 || b.face_count() == 0) return deviation_of_empty(a, b);
  const SurfaceIndex a_index(a);
  const SurfaceIndex b_index(b);
  const Goal goal = detail::goal_of(options, a, b, 0);
  Deviation result;
  result.mean_normal_angle = measure_means(a, b, b_index, options.sample_count, result.forward);
  measure_means(b, a, a_index, options.sample_count, result.backward);
  narrow_maximum(a, b, b_index, options, goal, result.forward);
  narrow_maximum(b, a, a_index, options, goal, result.backward);
  return result;
}

Deviation measure_maximum(const Mesh& a, const SurfaceIndex& a_index, const Mesh& b, const DeviationOptions& options,
                          double enough) {
  if (a.face_count() == 0 || b.face_count() == 0) return detail::maximum_of_empty(a, b);
  const SurfaceIndex b_index(b);
  SurfaceBounds a_bounds(a, false), b_bounds(b, false);
  PatchBound a_patch(a), b_patch(b);
  SupremumSearch forward(a, b_index, b_patch, a_bounds);
  SupremumSearch backward(b, a_index, a_patch, b_bounds);
  return detail::narrow_both(forward, backward, detail::goal_of(options, a, b, enough), options.budget);
}

}  // namespace lodestone

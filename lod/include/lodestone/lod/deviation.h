#pragma once

#include <cstddef>
#include <memory>

#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>
#include <lodestone/lod/surface_index.h>

namespace lodestone {

/// One direction of a comparison: the distances from one surface to the nearest points of the other, mesh units.
struct OneSidedDeviation {
  double maximum = 0;            ///< the largest distance found; a lower bound of the supremum
  double maximum_bound = 0;      ///< an upper bound of the supremum, ≥ maximum
  double mean = 0;               ///< over the samples of the first surface, see measure_deviation
  double rms = 0;                ///< the root of the mean square over the same samples
  std::size_t sample_count = 0;  ///< how many were taken
};

/// How two surfaces differ, both ways.
struct Deviation {
  OneSidedDeviation forward;     ///< from a to b
  OneSidedDeviation backward;    ///< from b to a
  double mean_normal_angle = 0;  ///< radians, between a's normal and b's at the nearest point, over a's area alone
  double maximum() const { return forward.maximum > backward.maximum ? forward.maximum : backward.maximum; }
  double maximum_bound() const {
    return forward.maximum_bound > backward.maximum_bound ? forward.maximum_bound : backward.maximum_bound;
  }
};

/// How closely to measure.
struct DeviationOptions {
  std::size_t sample_count = 200'000;  ///< about as many are taken for mean and rms, each way
  double relative_tolerance = 0.001;  ///< maximum_bound ≤ maximum·(1 + this) + absolute_tolerance, if the budget lasts
  double absolute_tolerance = 0;      ///< mesh units; 0: 1e-7 of the diagonal
  std::size_t budget =
      1'000'000;  ///< parts of faces to halve for narrowing the maximum, each way; about 100 bytes each
  /// Whether the maximum is narrowed each way by itself; else only the larger one is, and the other as far as that
  /// needs.
  bool each_way = true;
  /// Cancelled, measuring ends: maximum_bound is one still, infinity at worst, and the rest says nothing.
  Progress progress;
};

/// Returns the k-th of a sequence of points that spreads evenly over a face.
/// Source: M. Roberts, The unreasonable effectiveness of quasirandom sequences (2018): R2.
Vec3 point_on_face(const Mesh& mesh, Index face, std::size_t k);

/// A mesh prepared for being measured against others, once for all of them. It may be used by several threads.
class MeasuredSurface {
 public:
  /// Pre: `mesh` outlives the object.
  explicit MeasuredSurface(const Mesh& mesh);
  ~MeasuredSurface();
  MeasuredSurface(MeasuredSurface&&) noexcept;
  MeasuredSurface& operator=(MeasuredSurface&&) noexcept;

  const Mesh& mesh() const;
  const SurfaceIndex& index() const;

  struct Impl;  ///< opaque
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Measures the deviation of two surfaces, both ways. Deterministic. Empty meshes deviate by infinity from others.
///
/// `mean` and `rms` are not area means: to compare with published figures they are over the samples that Metro
/// (Cignoni, Rocchini, Scopigno, 1998) takes by default, each counting once. Of n samples, ten for each face of the
/// larger mesh and at least 100,000, one lies at each vertex; with m the rest and A the area, √(m/A) lie on each unit
/// of length of the edges, each edge taken once; what is left then is spread evenly over the faces. So finely meshed
/// parts weigh more than their area. Where faces are thinner than the step between such samples, Metro would take none
/// between their edges: there edges count the less the thinner the faces are, and the mean nears that of the area.
/// `options.sample_count` changes only how many samples are taken to estimate these, not what they are.
Deviation measure_deviation(const MeasuredSurface& a, const MeasuredSurface& b, const DeviationOptions& options = {});
Deviation measure_deviation(const Mesh& a, const Mesh& b, const DeviationOptions& options = {});

/// Measures only the two-sided maximum, narrowed as `options` says; mean and rms stay 0.
/// Stops early, with maximum_bound ≤ `enough`, where it can show that much: callers who need no more should say so.
Deviation measure_maximum(const MeasuredSurface& a, const MeasuredSurface& b, const DeviationOptions& options,
                          double enough = 0);

}  // namespace lodestone

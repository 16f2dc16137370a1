#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/fixed_point.h"
#include "codec/grid_points.h"
#include "codec/patch_mesh.h"

namespace lodestone::detail {

inline constexpr int kUnitBits = 14;   ///< fractional bits of unit vectors
inline constexpr int kRatioBits = 24;  ///< fractional bits of ratios of variances
inline constexpr int kScaleBits = 24;  ///< fractional bits of scales

/// What a length comes to where a ring's radius is this.
inline constexpr int kRadiusBits = 8;

/// Returns a vector times a scale, kScaleBits.
inline Vec3i scaled(const Vec3i& v, std::int64_t scale) {
  return {v.x * scale >> kScaleBits, v.y * scale >> kScaleBits, v.z * scale >> kScaleBits};
}
/// Returns a vector of length 1, or the zero vector for itself.
Vec3i unit(Vec3i v);
/// Finds the unit normals of `count` vertices or wedges, the mean of the faces around by area; `left` says which of
/// them a half-edge leaves.
template <class Left>
void look_at_normals(const PatchMesh& mesh, const GridPoints& positions, std::size_t count, const Left& left,
                     std::vector<Vec3i>& normals) {
  normals.assign(count, {});
  for (Index face = 0; face < mesh.face_count(); ++face) {
    const Vec3i p = positions[mesh.from(3 * face)];
    const Vec3i n = cross(positions[mesh.from(3 * face + 1)] - p, positions[mesh.from(3 * face + 2)] - p);
    for (Index half = 3 * face; half < 3 * face + 3; ++half) normals[left(half)] = normals[left(half)] + n;
  }
  for (Vec3i& n : normals) n = unit(n);
}

/// The length of a vector along a unit vector; a unit vector times a length.
inline std::int64_t along(const Vec3i& v, const Vec3i& unit) { return dot(v, unit) >> kUnitBits; }
inline Vec3i times(const Vec3i& unit, std::int64_t length) {
  return {unit.x * length >> kUnitBits, unit.y * length >> kUnitBits, unit.z * length >> kUnitBits};
}

/// The ring of a new vertex, and what it tells of where the vertex lies. Lengths are in sixteenths of the grid's step.
class Ring {
 public:
  static constexpr int kPulls = 4;

  /// Looks at the star of a vertex: `outer`, the half-edges across from it, in order; `normals` are those of the
  /// vertices around.
  void look(const PatchMesh& mesh, std::span<const Index> outer, bool closed, const GridPoints& positions,
            std::span<const Vec3i> normals);

  std::span<const Index> corners() const { return corners_; }
  /// The vertices beyond its edges.
  std::span<const Index> beyond() const { return beyond_; }
  int size() const { return static_cast<int>(corners_.size()); }

  Vec3i mean;                    ///< of the corners; where the ring is open, of its ends
  Vec3i normal;                  ///< unit; 0 where it has none
  std::int64_t radius = 0;       ///< ≥ 16
  std::int64_t over_radius = 0;  ///< kRadius over it, kScaleBits
  /// Where else the vertex may lie, seen from the mean: the mean of the vertices beyond; of the edges, the longer the
  /// more; of the corners of parallelograms, the smaller the more; of the corners' tangent planes.
  std::array<Vec3i, kPulls> pulls;
  std::int64_t spread[3][3] = {};  ///< covariance of the corners across the normal, of trace 2, kRatioBits
  int log_least = 0;               ///< 16 · log2 of the shortest radius
  int log_edge = 0;                ///< of the mean edge
  int log_beyond = 0;              ///< of the mean distance of the vertices beyond

 private:
  void find_mean(std::span<const Index> outer, bool closed);
  void find_pulls(const PatchMesh& mesh, std::span<const Index> outer, const GridPoints& positions,
                  std::span<const Vec3i> normals);
  void find_spread();

  std::vector<Index> corners_;
  std::vector<Index> beyond_;
  std::vector<Vec3i> points_;  // the corners', sixteenths
};

}  // namespace lodestone::detail

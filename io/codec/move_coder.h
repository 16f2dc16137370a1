#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/coordinate_coder.h"
#include "codec/fixed_point.h"
#include "codec/number_coder.h"
#include "codec/online_fit.h"
#include "codec/patch_mesh.h"
#include "codec/ring.h"
#include "codec/shift_fit.h"

namespace lodestone::detail {

/// Codes where vertices of a level go that its rounds move, each from where it lies and the ring around it.
class MoveCoder {
 public:
  explicit MoveCoder(int grid_bits);

  /// From now on vertices that lie on multiples of 2^`from` go to multiples of 2^`to`; none of so many has moved.
  void start(int from, int to, std::size_t vertex_count);

  /// Codes where a vertex goes. `half`: a half-edge that leaves it, or kNoIndex; `normals`: of the vertices. False
  /// where what is read lies off the grid.
  bool code(BitCoder& coder, const PatchMesh& mesh, Index vertex, Index half, std::span<const Vec3i> positions,
            std::span<const Vec3i> normals, Vec3i& position);

 private:
  static constexpr int kPulls = 4;
  static constexpr int kTraits = 6;
  using Traits = OnlineFit<kTraits>;

  bool find_star(const PatchMesh& mesh, Index half);
  void find_misses();

  int grid_bits_;
  int from_ = 0, to_ = 0;
  CoordinateCoder coordinates_;
  NumberCoder bare_;  // of vertices without faces
  ShiftFit<kPulls> shift_;
  Traits normal_size_, tangent_size_;
  std::vector<std::optional<Miss>> misses_;  // by vertex that has moved, over the ring's radius
  std::vector<Vec3i> went_;                  // by vertex: how far, sixteenths

  // Of the vertex at hand.
  std::vector<Index> outer_;
  bool closed_ = false;
  Ring ring_;
  std::optional<Miss> around_;
  Vec3i went_around_;  // mean of those that have moved
  Traits::Features traits_{};
};

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <cstdint>
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

/// Codes the positions of vertices on a grid, each from the ring around it.
class PointCoder {
 public:
  explicit PointCoder(int grid_bits);

  /// From now on coordinates are multiples of 2^shift.
  void set_step(int shift) { shift_ = shift; }
  std::span<const Vec3i> normals() const { return normals_; }

  /// Codes the next vertex of the base mesh. False where what is read lies off the grid.
  bool code_base(BitCoder& coder, Vec3i& position);
  /// Codes the next vertex, which has no ring. False where what is read lies off the grid.
  bool code_loose(BitCoder& coder, const Vec3i& guess, Vec3i& position);

  /// Looks at the level before a round.
  void start_round(const PatchMesh& mesh, std::span<const Vec3i> positions);

  /// Guesses where a new vertex lies, for those that are coded before it. `star`: its faces in order, it first in each.
  static Vec3i guess(const PatchMesh& mesh, std::span<const Index> star, bool closed, std::span<const Vec3i> positions);

  /// Codes the next vertex: `position` is what a writer has, and a reader gets. Those of its round that follow have a
  /// guess. False where what is read lies off the grid.
  bool code(BitCoder& coder, const PatchMesh& mesh, std::span<const Index> star, bool closed,
            std::span<const Vec3i> positions, Vec3i& position);

 private:
  static constexpr int kSizes = 4;   // of rings, told apart where positions are predicted
  static constexpr int kTraits = 9;  // of a ring, from which the size of errors is predicted
  using Traits = OnlineFit<kTraits>;

  struct Prediction {
    Vec3i point;
    Miss size;  // expected, sixteenths of the logarithm in sixteenths of a step
    Traits::Features normal_traits{}, tangent_traits{};
  };

  void find_misses();
  void predict(bool closed);
  void predict_size(const ShiftFit<Ring::kPulls>& shift);
  void learn(const Vec3i& position, bool closed);
  std::size_t size_class(bool closed) const;

  int grid_bits_;
  int shift_ = 0;
  NumberCoder base_;
  NumberCoder loose_;
  CoordinateCoder coordinates_;
  std::vector<ShiftFit<Ring::kPulls>> shifts_;  // by class of ring size
  Traits normal_size_, tangent_size_;

  std::vector<Vec3i> normals_;  // by vertex of the level before the round
  std::vector<Miss> misses_;    // by vertex, over the ring's radius
  std::size_t base_count_ = 0;

  // Of the vertex at hand.
  std::vector<Index> outer_;
  Ring ring_;
  Miss around_;  // mean of those around
  bool has_misses_ = false;
  Prediction prediction_;
};

}  // namespace lodestone::detail

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/fixed_point.h"
#include "codec/grid_points.h"
#include "codec/number_coder.h"
#include "codec/patch_mesh.h"

namespace lodestone::detail {

/// Codes positions of vertices on a grid: where new ones lie and where those of the level go, each from the ring around
/// it.
class ShapeCoder {
 public:
  explicit ShapeCoder(int grid_bits) : grid_bits_(grid_bits) {}
  ShapeCoder(const ShapeCoder&) = delete;
  ShapeCoder& operator=(const ShapeCoder&) = delete;
  virtual ~ShapeCoder() = default;

  static std::unique_ptr<ShapeCoder> make(bool is_fast, int grid_bits);

  /// From now on coordinates are multiples of 2^`to`; so many vertices lie on multiples of 2^`from` yet, and none of
  /// them has moved.
  void start_stage(int from, int to, std::size_t vertex_count);
  /// Looks at the level before a round, or before the vertices of a stage that are left move.
  virtual void start_round(const PatchMesh& mesh, const GridPoints& positions) = 0;

  // Of these, `position` is what a writer has, and a reader gets; false where what is read lies off the grid.

  /// Codes the next vertex of the base mesh.
  bool code_base(BitCoder& coder, Vec3i& position);
  /// Codes the next vertex, which has no ring.
  bool code_loose(BitCoder& coder, const Vec3i& guess, Vec3i& position);
  /// Codes the next vertex. `star`: its faces in order, it first in each. Those of its round that follow have a guess.
  bool code_point(BitCoder& coder, const PatchMesh& mesh, std::span<const Index> star, bool closed,
                  const GridPoints& positions, Vec3i& position);
  /// Codes where a vertex goes. `half`: a half-edge that leaves it, or kNoIndex.
  bool code_move(BitCoder& coder, const PatchMesh& mesh, Index vertex, Index half, const GridPoints& positions,
                 Vec3i& position);

  /// Guesses where a new vertex lies, for those that are coded before it.
  static Vec3i guess(const PatchMesh& mesh, std::span<const Index> star, bool closed, const GridPoints& positions);

 protected:
  /// What is around a vertex: the half-edges across from it, in order.
  struct Around {
    const PatchMesh& mesh;
    std::span<const Index> outer;
    bool closed;
    const GridPoints& positions;
  };
  virtual void add_base() = 0;
  virtual void add_loose() = 0;
  virtual void forget_moves(std::size_t vertex_count) = 0;
  virtual bool code_new(BitCoder& coder, const Around& around, Vec3i& position) = 0;
  virtual bool code_moved(BitCoder& coder, const Around& around, Index vertex, Vec3i& position) = 0;

  bool is_on_grid(const Vec3i& position) const;
  int from() const { return from_; }
  int step() const { return step_; }

 private:
  bool code_numbers(BitCoder& coder, NumberCoder& numbers, const Vec3i& value, std::int64_t scale,
                    Vec3i& position) const;
  void find_star(const PatchMesh& mesh, Index half);

  int grid_bits_;
  int from_ = 0, step_ = 0;
  NumberCoder base_, loose_;
  NumberCoder bare_;  // of vertices without faces, where they go
  std::vector<Index> outer_;
  bool closed_ = false;
};

}  // namespace lodestone::detail

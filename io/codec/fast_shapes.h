#pragma once

#include <optional>
#include <vector>

#include "codec/coordinate_coder.h"
#include "codec/shape_coder.h"

namespace lodestone::detail {

/// Positions by fixed predictions; the sizes of their errors are those of errors around.
class FastShapes final : public ShapeCoder {
 public:
  explicit FastShapes(int grid_bits) : ShapeCoder(grid_bits) {}

  void start_round(const PatchMesh&, const GridPoints&) override {}

 private:
  /// A point that is expected, and how far from it. Lengths in sixteenths of the grid's step.
  struct Expected {
    Vec3i point;
    Vec3i normal;  ///< of any length
    int axis = 2;  ///< in which that is longest
    Miss size;     ///< logarithms: along the axis, from the plane across the normal; and in the other coordinates
  };

  void add_base() override;
  void add_loose() override;
  void forget_moves(std::size_t vertex_count) override { moved_.assign(vertex_count, std::nullopt); }
  bool code_new(BitCoder& coder, const Around& around, Vec3i& position) override;
  bool code_moved(BitCoder& coder, const Around& around, Index vertex, Vec3i& position) override;

  void gather(const Around& around);
  void expect(const Around& around);
  Miss code_near(BitCoder& coder, NumberCoder& numbers, Vec3i& position) const;

  NumberCoder new_, moves_;
  std::vector<Miss> misses_;  // by vertex: over the ring's radius
  std::size_t base_count_ = 0;
  std::vector<std::optional<Miss>> moved_;  // by vertex that has moved

  // Of the vertex at hand.
  struct Corner {
    Index vertex, beyond;
  };
  std::vector<Corner> ring_;  // and once more its last corner
  Expected expected_;
  int log_radius_ = 0;
};

}  // namespace lodestone::detail

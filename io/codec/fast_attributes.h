#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/attribute_coder.h"
#include "codec/direction_coder.h"
#include "codec/wedge_misses.h"

namespace lodestone::detail {

/// Directions near what the surface tells: its normals, and where texture coordinates grow on it.
class FastDirectionCoder final : public DirectionCoder {
 public:
  explicit FastDirectionCoder(const AttributeSpec& spec);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace& place) override { misses_.note(place.wedge, misses_.usual()); }

 private:
  Vec3i numbers_of(Index wedge) const { return {number(wedge, 0), number(wedge, 1), number(wedge, 2)}; }
  Vec3i around(const ElementPlace& place) const;
  Vec3i tangent(const ElementPlace& place, bool& is_mirrored) const;

  WedgeMisses misses_;
};

/// Texture coordinates by the plane that fits those of the ring best, over the coordinates of positions that are not
/// the steepest.
class FastTextureCoder final : public ElementCoder {
 public:
  explicit FastTextureCoder(const AttributeSpec& spec);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace& place) override { misses_.note(place.wedge, misses_.usual()); }

 private:
  using Pair = std::array<std::int64_t, 2>;
  struct Point {
    std::int64_t x = 0, y = 0;  ///< as seen from the vertex, of about ten bits
    Pair value{};               ///< sixteenths
  };
  void gather(const ElementPlace& place);
  Pair expect(std::int64_t& radius) const;

  NumberCoder numbers_, alone_;
  WedgeMisses misses_;         // over the radius
  std::vector<Point> points_;  // the ring of the wedge at hand
};

}  // namespace lodestone::detail

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/attribute_coder.h"
#include "codec/online_fit.h"
#include "codec/wedge_misses.h"

namespace lodestone::detail {

/// Codes pairs of numbers that are close to a linear map of the surface, as texture coordinates are.
class FittedTextureCoder final : public ElementCoder {
 public:
  explicit FittedTextureCoder(const AttributeSpec& spec);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace& place) override { misses_.note(place.wedge, misses_.usual()); }

 private:
  static constexpr int kPulls = 3;
  static constexpr int kTraits = 7;
  using Pulls = OnlineFit<kPulls>;
  using Traits = OnlineFit<kTraits>;
  using Pair = std::array<std::int64_t, 2>;

  /// A point of the chart: where it lies across the normal, seen from the vertex, and its numbers, in sixteenths.
  struct Point {
    std::int64_t x = 0, y = 0;
    Pair value{};
  };
  /// What the ring tells.
  struct Guess {
    Pair mean{};
    std::int64_t radius = 16;  // of the ring's numbers around their mean, sixteenths
    std::array<Pair, kPulls> pulls{};
    std::int64_t bend = 0;  // how far the ring is from a linear map
  };

  bool code_alone(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers);
  bool code_pair(BitCoder& coder, const Pair& expected, std::int64_t error, std::uint32_t kind, std::uint32_t hint,
                 std::span<std::int32_t> numbers);
  void gather(const ElementPlace& place);
  void add_point(const ElementPlace& place, const Vec3i& along_x, const Vec3i& along_y, Index wedge);
  Guess look();
  void fit_plane(std::size_t count, Guess& guess) const;

  NumberCoder numbers_, alone_;
  std::array<Pulls, 2> pulls_;  // by whether the sector is open
  std::array<Traits, 2> size_;
  WedgeMisses misses_;  // over the radius

  // Of the wedge at hand.
  std::vector<Point> points_;  // the ring's, then what lies beyond
  std::size_t ring_count_ = 0;
  bool is_open_ = false;
};

}  // namespace lodestone::detail

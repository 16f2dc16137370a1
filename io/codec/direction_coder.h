#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/attribute_coder.h"
#include "codec/online_fit.h"

namespace lodestone::detail {

/// Codes directions: normals close to those of the surface, tangents close to where texture coordinates grow.
class DirectionCoder final : public ElementCoder {
 public:
  explicit DirectionCoder(const AttributeSpec& spec);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace& place) override;

 private:
  static constexpr int kPulls = 4;
  static constexpr int kTraits = 8;
  using Pulls = OnlineFit<kPulls>;
  using Traits = OnlineFit<kTraits>;

  Vec3i direction(Index wedge) const;
  Vec3i mean_of_ring(const ElementPlace& place) const;
  bool code_point(BitCoder& coder, const Vec3i& expected, int log_error, std::uint32_t kind,
                  std::span<std::int32_t> numbers);
  bool code_sign(BitCoder& coder, const ElementPlace& place, bool is_mirrored, std::span<std::int32_t> numbers);
  void note_miss(Index wedge, int miss);

  NumberCoder numbers_;
  BitMixer bits_{std::array<std::uint32_t, 1>{16}, 1};
  Pulls pulls_;
  Traits size_;
  std::vector<std::int16_t> misses_;  // by wedge: sixteenths of the logarithm of the error
};

}  // namespace lodestone::detail

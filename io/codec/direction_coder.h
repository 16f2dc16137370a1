#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/attribute_coder.h"
#include "codec/online_fit.h"
#include "codec/wedge_misses.h"

namespace lodestone::detail {

/// Calls `visit(growth)` for each face of a wedge: where the first texture coordinate grows on it, of any length. True
/// where texture coordinates run the other way round on most. Pre: there are some.
template <class Visit>
bool visit_growth(const ElementPlace& place, const Visit& visit) {
  int turns = 0;
  for (const Index face : place.faces) {
    const auto at = [&](Index corner, std::size_t c) {
      return std::int64_t{place.texture->numbers(place.mesh.wedge(3 * face + corner))[c]};
    };
    const auto [a, b] = place.edges(face);
    const std::int64_t au = at(1, 0) - at(0, 0), av = at(1, 1) - at(0, 1);
    const std::int64_t bu = at(2, 0) - at(0, 0), bv = at(2, 1) - at(0, 1);
    const int turn = au * bv > bu * av ? 1 : -1;
    visit((a * bv - b * av) * turn);
    turns += turn;
  }
  return turns < 0;
}

/// Codes directions: points of an octahedron.
class DirectionCoder : public ElementCoder {
 protected:
  explicit DirectionCoder(const AttributeSpec& spec) : ElementCoder(spec) {}

  /// Codes a direction near one of any length, not longer than 2^24, and learns how far off that was: see off().
  /// `guess`: what is known of its numbers but their values; their kind is the first of two.
  bool code_point(BitCoder& coder, const Vec3i& expected, NumberCoder::Guess guess, std::span<std::int32_t> numbers);
  /// Codes a fourth component. `is_mirrored`: whether texture coordinates run the other way round.
  void code_sign(BitCoder& coder, const ElementPlace& place, bool is_mirrored, std::span<std::int32_t> numbers);
  /// How far the numbers coded last were off altogether, sixteenths.
  std::int64_t off() const { return off_; }

 private:
  NumberCoder numbers_;
  BitMixer<1> bits_{{16}, 1};
  std::int64_t off_ = 0;
};

/// Normals are close to those of the surface, tangents close to where texture coordinates grow: how close, is learnt.
class FittedDirectionCoder final : public DirectionCoder {
 public:
  explicit FittedDirectionCoder(const AttributeSpec& spec);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace& place) override;

 private:
  static constexpr int kPulls = 4;
  static constexpr int kTraits = 8;
  using Pulls = OnlineFit<kPulls>;
  using Traits = OnlineFit<kTraits>;

  Vec3i direction(Index wedge) const;
  Vec3i note_direction(Index wedge);
  Vec3i mean_of_ring(const ElementPlace& place) const;
  bool code_near(BitCoder& coder, const Vec3i& expected, int log_error, std::uint32_t kind,
                 std::span<std::int32_t> numbers);

  Pulls pulls_;
  Traits size_;
  WedgeMisses misses_;
  std::vector<std::array<std::int16_t, 3>> directions_;  // by wedge that has numbers: unit vectors
};

}  // namespace lodestone::detail

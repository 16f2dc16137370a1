#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/detail/hash_index.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// Finds points by their positions.
///
/// Two points are at one place where their coordinates are equal as numbers: −0 is 0, and what is not a number equals
/// nothing. A point with such a coordinate has a place of its own, where it is never found.
class PositionIndex {
 public:
  /// The positions outlive it.
  explicit PositionIndex(std::span<const Vec3f> positions) : positions_(positions), table_(positions.size()) {}

  /// Adds a point, once; returns the first one that was added at its place.
  Index add(Index point) {
    const Vec3f& position = positions_[point];
    return table_.find_or_insert(hash(position), point, [&](Index other) { return positions_[other] == position; });
  }

  /// Adds all points in turn; returns the first one at the place of each.
  std::vector<Index> add_all() {
    std::vector<Index> first(positions_.size());
    for (Index point = 0; point < first.size(); ++point) first[point] = add(point);
    return first;
  }

  /// Returns the first point that was added at a position, kNoIndex where none was.
  Index find(const Vec3f& position) const {
    return table_.find(hash(position), [&](Index other) { return positions_[other] == position; });
  }

 private:
  static std::uint64_t hash(const Vec3f& p) {
    // Adding zero turns −0 into 0: the two have to hash alike.
    const auto bits = [](float f) { return std::uint64_t{std::bit_cast<std::uint32_t>(f + 0.0F)}; };
    return mix_bits(mix_bits(mix_bits(bits(p.x)) + bits(p.y)) + bits(p.z));
  }

  std::span<const Vec3f> positions_;
  HashIndex table_;
};

/// Returns for each point the first one at its place.
inline std::vector<Index> places_of(std::span<const Vec3f> positions) { return PositionIndex(positions).add_all(); }

}  // namespace lodestone::detail

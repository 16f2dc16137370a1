#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

using Triple = std::array<std::uint32_t, 3>;

/// A map from three 32-bit words, a position's or a face's, to an index: open addressing, linear probing.
class TripleTable {
 public:
  /// Pre: at most `capacity` triples will be inserted.
  explicit TripleTable(std::size_t capacity = 0) : slots_(std::bit_ceil(2 * capacity + 2)) {}

  /// Returns the index stored for `key`, or kNoIndex.
  Index find(const Triple& key) const { return slots_[slot_of(key)].value; }

  /// Stores `value` for `key` unless there is one already; returns the one stored.
  Index insert(const Triple& key, Index value) {
    Slot& slot = slots_[slot_of(key)];
    if (slot.value == kNoIndex) slot = {key, value};
    return slot.value;
  }

 private:
  struct Slot {
    Triple key{};
    Index value = kNoIndex;
  };

  std::size_t slot_of(const Triple& key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = hash(key) & mask;
    while (slots_[i].value != kNoIndex && slots_[i].key != key) i = (i + 1) & mask;
    return i;
  }

  static std::size_t hash(const Triple& key) {
    std::uint64_t h = (std::uint64_t{key[0]} << 32 | key[1]) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 29) ^ key[2]) * 0xbf58476d1ce4e5b9ULL;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }

  std::vector<Slot> slots_;
};

}  // namespace lodestone::detail

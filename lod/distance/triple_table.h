#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

using Triple = std::array<std::uint32_t, 3>;

/// A map from three numbers, such as a face's corners, to an index: open addressing, linear probing. It keeps the
/// numbers beside the index, to look them up fast in meshes of millions of faces.
class TripleTable {
 public:
  /// Pre: at most `capacity` triples will be inserted.
  explicit TripleTable(std::size_t capacity = 0) : slots_(capacity + capacity / 2 + 2) {}

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
    // The upper half of the hash, as a share of the table: any size will do, not only powers of two.
    std::size_t i = static_cast<std::size_t>((hash(key) >> 32) * slots_.size() >> 32);
    while (slots_[i].value != kNoIndex && slots_[i].key != key) i = i + 1 < slots_.size() ? i + 1 : 0;
    return i;
  }

  static std::uint64_t hash(const Triple& key) {
    std::uint64_t h = (std::uint64_t{key[0]} << 32 | key[1]) * 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 29) ^ key[2]) * 0xbf58476d1ce4e5b9ULL;
    return h ^ (h << 32);
  }

  std::vector<Slot> slots_;
};

}  // namespace lodestone::detail

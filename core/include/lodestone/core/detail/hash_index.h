#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// Mixes a 64-bit value into a hash (the finaliser of SplitMix64).
inline std::uint64_t mix_bits(std::uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
  return h ^ (h >> 31);
}

/// Numbers distinct things in order of first appearance: an open-addressing table of indices into the caller's array.
class HashIndex {
 public:
  explicit HashIndex(std::size_t expected) : slots_(std::bit_ceil(2 * expected + 16), kNoIndex) {}

  /// Returns the entry equal to the one looked for, or inserts `candidate` and returns it.
  /// `equal(entry)` compares an earlier entry with it. Pre: at most `expected` insertions.
  template <class Equal>
  Index find_or_insert(std::uint64_t hash, Index candidate, const Equal& equal) {
    Index& entry = slots_[slot_of(hash, equal)];
    if (entry == kNoIndex) entry = candidate;
    return entry;
  }

  /// Returns the entry equal to the one looked for; kNoIndex where there is none.
  template <class Equal>
  Index find(std::uint64_t hash, const Equal& equal) const {
    return slots_[slot_of(hash, equal)];
  }

 private:
  template <class Equal>
  std::size_t slot_of(std::uint64_t hash, const Equal& equal) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = hash & mask;
    while (slots_[i] != kNoIndex && !equal(slots_[i])) i = (i + 1) & mask;
    return i;
  }

  std::vector<Index> slots_;
};

}  // namespace lodestone::detail

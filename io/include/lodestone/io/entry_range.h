#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lodestone {

/// Entries of a buffer: [begin, end).
struct EntryRange {
  std::size_t begin = 0;
  std::size_t end = 0;

  std::size_t size() const { return end - begin; }
  friend bool operator==(const EntryRange&, const EntryRange&) = default;
};

namespace detail {

/// Items that changed, of some entries each, in blocks: a bit for each.
class ChangedEntries {
 public:
  static constexpr std::size_t kBlock = 64;

  explicit ChangedEntries(std::size_t entries_each) : entries_each_(entries_each) {}
  void make_room(std::size_t item_count);
  void mark(std::size_t item) {
    const std::size_t block = item / kBlock;
    bits_[block / 64] |= std::uint64_t{1} << block % 64;
  }
  void mark(std::size_t first, std::size_t end);
  /// Gives the ranges of what was marked since they were taken last, of the first `item_count` items: ascending, none
  /// empty, those within `gap` entries of each other as one.
  void take(std::size_t item_count, std::size_t gap, std::vector<EntryRange>& ranges);

 private:
  std::size_t entries_each_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace detail
}  // namespace lodestone

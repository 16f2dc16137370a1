#include <lodestone/io/entry_range.h>

#include <algorithm>
#include <bit>

namespace lodestone::detail {

void ChangedEntries::make_room(std::size_t item_count) {
  const std::size_t blocks = (item_count + kBlock - 1) / kBlock, words = (blocks + 63) / 64;
  if (words > bits_.size()) bits_.resize(words, 0);
}

void ChangedEntries::mark(std::size_t first, std::size_t end) {
  for (std::size_t item = first; item < end; item = (item / kBlock + 1) * kBlock) mark(item);
}

/// Those of items that are no more count for nothing: they are marked again where they come back.
void ChangedEntries::take(std::size_t item_count, std::size_t gap, std::vector<EntryRange>& ranges) {
  ranges.clear();
  for (std::size_t word = 0; word < bits_.size(); ++word)
    for (std::uint64_t bits = bits_[word]; bits != 0; bits &= bits - 1) {
      const std::size_t block = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      const EntryRange changed = {entries_each_ * kBlock * block,
                                  entries_each_ * std::min(kBlock * (block + 1), item_count)};
      if (changed.begin >= changed.end) continue;
      if (!ranges.empty() && changed.begin - ranges.back().end <= gap)
        ranges.back().end = changed.end;
      else
        ranges.push_back(changed);
    }
  std::fill(bits_.begin(), bits_.end(), 0);
}

}  // namespace lodestone::detail

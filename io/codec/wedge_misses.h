#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/attribute_coder.h"

namespace lodestone::detail {

/// How far predictions were off, by wedge: sixteenths of logarithms.
class WedgeMisses {
 public:
  explicit WedgeMisses(int usual) : usual_(usual) {}
  /// Of wedges of which nothing is known.
  int usual() const { return usual_; }
  int of(Index wedge) const { return wedge < misses_.size() ? misses_[wedge] : usual_; }
  void note(Index wedge, int miss) {
    if (misses_.size() <= wedge) misses_.resize(wedge + std::size_t{1}, static_cast<std::int16_t>(usual_));
    misses_[wedge] = static_cast<std::int16_t>(miss);
  }
  /// The mean of a ring's.
  int around(const ElementPlace& place) const {
    int sum = 0;
    for (const Index other : place.ring) sum += of(other);
    return place.ring.empty() ? usual_ : sum / static_cast<int>(place.ring.size());
  }

 private:
  int usual_;
  std::vector<std::int16_t> misses_;
};

}  // namespace lodestone::detail

#include "distance/face_history.h"

#include <algorithm>
#include <limits>

#include "distance/round_up.h"

namespace lodestone::detail {
namespace {

// Periods that are remembered, and faces' numbers that they may have for each face of the mesh.
constexpr std::size_t kMostPeriods = 5;
constexpr std::size_t kMostRemembered = 2;

}  // namespace

void FaceHistory::end_period() {
  std::size_t remembered = 0;
  for (const FaceChanges& period : periods_) remembered += period.face_count();
  while (periods_.size() >= kMostPeriods || (remembered > kMostRemembered * face_count_ && !periods_.empty())) {
    remembered -= periods_.front().face_count();
    periods_.pop_front();
    ++first_period_;
  }
  periods_.emplace_back();
}

/// Goes back over a period, from the fates since it was over to those since it began.
void FaceHistory::undo(const FaceChanges& changes, std::vector<Fate>& fates) {
  for (std::size_t i = changes.size(); i-- > 0;) {
    const FaceChange change = changes[i];
    Fate before;
    const auto take = [&](Index face) {
      const Fate& after = fates[face];
      before.moved = std::max({before.moved, after.moved, 0.0F});
      if (before.heir == kNoIndex) before.heir = after.is_there() ? face : after.heir;
    };
    std::for_each(change.fresh().begin(), change.fresh().end(), take);
    std::for_each(change.beside.begin(), change.beside.end(), take);
    const bool any = !before.is_there();  // else nothing is known of where it has gone
    before.moved = any ? round_up(static_cast<double>(before.moved) + static_cast<double>(change.moved))
                       : std::numeric_limits<float>::infinity();
    for (const Index face : change.gone) fates[face] = before;
  }
}

}  // namespace lodestone::detail

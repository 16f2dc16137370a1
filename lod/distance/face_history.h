#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "distance/face_change.h"

namespace lodestone::detail {

/// What removals have done to the faces of a mesh, in periods, of which the oldest are forgotten.
class FaceHistory {
 public:
  /// What has become of a face since a period began.
  struct Fate {
    float moved = -1;  ///< the surface is now no farther from any of its points, mesh units; < 0: it is still there
    Index heir = kNoIndex;  ///< a face that took its place, once it is gone

    bool is_there() const { return moved < 0; }
  };

  explicit FaceHistory(std::size_t face_count) : face_count_(face_count), periods_(1) {}

  /// The period that is not over yet, and its number.
  FaceChanges& now() { return periods_.back(); }
  Index period() const { return first_period_ + static_cast<Index>(periods_.size()) - 1; }
  /// Ends the period; the next one begins.
  void end_period();

  /// Calls `visit(period, fates)` for each period that is remembered, the last one first. The fates, by face, are
  /// those since it began, of the faces that there were then. Cost: O(n), and linear in what is remembered.
  template <class Visit>
  void look_back(const Visit& visit) const {
    std::vector<Fate> fates(face_count_);
    for (std::size_t i = periods_.size(); i-- > 0;) {
      undo(periods_[i], fates);
      visit(first_period_ + static_cast<Index>(i), std::span<const Fate>(fates));
    }
  }

 private:
  static void undo(const FaceChanges& changes, std::vector<Fate>& fates);

  std::size_t face_count_;
  std::deque<FaceChanges> periods_;  // the last one is not over
  Index first_period_ = 0;
};

}  // namespace lodestone::detail

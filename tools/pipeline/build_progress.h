#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <vector>

#include <lodestone/pipeline/build_asset.h>

namespace lodestone::detail {

/// Adds up the progress of what threads do in one stage, for the observer; any thread may report.
class StageProgress {
 public:
  /// `weights`: of the parts of the work. They are done between two shares of the stage.
  StageProgress(BuildObserver& observer, BuildStage stage, std::vector<double> weights, double begin = 0,
                double end = 1);

  /// Says how much of a part is done, 0 to 1; returns false where the observer wants no more.
  bool update(std::size_t part, double share);
  bool is_cancelled() const { return is_cancelled_; }

 private:
  BuildObserver& observer_;
  BuildStage stage_;
  std::mutex mutex_;
  std::vector<double> weight_, share_;
  double total_ = 0, begin_, end_;
  std::atomic<bool> is_cancelled_ = false;
};

/// What a cancelled build ends with.
tl::unexpected<Error> cancelled();

}  // namespace lodestone::detail

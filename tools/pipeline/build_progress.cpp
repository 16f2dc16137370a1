#include "pipeline/build_progress.h"

#include <numeric>
#include <utility>

namespace lodestone::detail {

StageProgress::StageProgress(BuildObserver& observer, BuildStage stage, std::vector<double> weights, double begin,
                             double end)
    : observer_(observer),
      stage_(stage),
      weight_(std::move(weights)),
      share_(weight_.size(), 0),
      total_(std::accumulate(weight_.begin(), weight_.end(), 0.0)),
      begin_(begin),
      end_(end) {
  is_cancelled_ = !observer_.progress(stage_, begin_);
}

bool StageProgress::update(std::size_t part, double share) {
  const std::scoped_lock lock(mutex_);
  if (is_cancelled_) return false;
  share_[part] = share;
  const double done = std::inner_product(weight_.begin(), weight_.end(), share_.begin(), 0.0);
  is_cancelled_ = !observer_.progress(stage_, begin_ + (end_ - begin_) * (total_ > 0 ? done / total_ : 1));
  return !is_cancelled_;
}

tl::unexpected<Error> cancelled() { return fail(ErrorCode::Cancelled, "cancelled"); }

}  // namespace lodestone::detail

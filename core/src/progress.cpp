#include <lodestone/core/progress.h>

#include <algorithm>
#include <atomic>
#include <mutex>

namespace lodestone {

/// Whom all parts of a piece of work report to.
struct Progress::Audience {
  std::function<bool(double)> listener;
  std::mutex mutex;
  std::atomic<bool> is_cancelled = false;
};

/// A part knows the one that it belongs to, up to the whole: what is done of it is done of these, too.
struct Progress::Part {
  std::shared_ptr<Audience> audience;
  std::shared_ptr<Part> whole;
  double share = 1;  // of `whole`
  double done = 0;   // of the part; under the audience's lock

  bool raise(double more) {
    double so_far = 0;
    for (Part* part = this; part != nullptr; part = part->whole.get()) {
      so_far = std::clamp(part->done + more, part->done, 1.0);
      more = (so_far - part->done) * part->share;
      part->done = so_far;
    }
    if (!audience->listener(so_far)) audience->is_cancelled = true;
    return !audience->is_cancelled;
  }
};

Progress::Progress(Calls calls) {
  if (!calls.listener) return;
  part_ = std::make_shared<Part>();
  part_->audience = std::make_shared<Audience>();
  part_->audience->listener = std::move(calls.listener);
}

Progress Progress::part(double share) const {
  if (part_ == nullptr) return {};
  return Progress(std::make_shared<Part>(Part{part_->audience, part_, share}));
}

bool Progress::reach(double done) const {
  if (part_ == nullptr) return true;
  const std::scoped_lock lock(part_->audience->mutex);
  return !part_->audience->is_cancelled && part_->raise(done - part_->done);
}

bool Progress::add(double share) const {
  if (part_ == nullptr) return true;
  const std::scoped_lock lock(part_->audience->mutex);
  return !part_->audience->is_cancelled && part_->raise(share);
}

bool Progress::is_cancelled() const { return part_ != nullptr && part_->audience->is_cancelled; }

}  // namespace lodestone

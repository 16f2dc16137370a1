#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

namespace lodestone {

/// How far a piece of work is: who does it says so here, and hears whether it is still wanted. Copies are of the same
/// work. Any thread may call; the listener hears one call at a time, and shares that never fall.
class Progress {
 public:
  /// Nobody listens, and nobody cancels.
  Progress() = default;

  /// `listener(done)` is told the share of the work that is done, 0 to 1, many times a second. It returns false to
  /// cancel the work, and is not called again then.
  template <std::predicate<double> Listener>
  requires(!std::same_as<std::remove_cvref_t<Listener>, Progress>) Progress(Listener&& listener)
      : Progress(Calls{std::forward<Listener>(listener)}) {}  // NOLINT: as the function itself

  /// A part of the work that makes up a share of it. With 0 it does nothing but hear.
  Progress part(double share) const;

  /// Says that so much is done by now, 0 to 1; what is less than was said before changes nothing. Returns false where
  /// the work is cancelled: whoever does it returns soon.
  bool reach(double done) const;
  /// Says that so much more is done. Returns as above.
  bool add(double share) const;
  /// Asks only, without a call of the listener.
  bool is_cancelled() const;

 private:
  struct Calls {
    std::function<bool(double)> listener;
  };
  struct Audience;
  struct Part;
  explicit Progress(Calls calls);
  explicit Progress(std::shared_ptr<Part> part) : part_(std::move(part)) {}

  std::shared_ptr<Part> part_;  // none where nobody listens
};

/// Counts the steps of a loop and reports one in so many of them: cheap enough for steps of nanoseconds.
class ProgressSteps {
 public:
  /// Nobody listens.
  ProgressSteps() = default;
  /// `count` steps make up all of the work. 0: they only hear.
  ProgressSteps(Progress progress, std::size_t count, std::size_t every)
      : progress_(std::move(progress)),
        share_(count > 0 ? static_cast<double>(every) / static_cast<double>(count) : 0),
        every_(every),
        left_(every) {}

  /// Takes a step; returns false once the work is cancelled.
  bool next() { return --left_ > 0 || report(); }

 private:
  bool report() {
    const bool goes_on = progress_.add(share_);
    left_ = goes_on ? every_ : 1;
    return goes_on;
  }

  Progress progress_;
  double share_ = 0;
  std::size_t every_ = kNever, left_ = kNever;
  static constexpr std::size_t kNever = static_cast<std::size_t>(-1);
};

}  // namespace lodestone

#pragma once

#include <mutex>
#include <optional>

namespace lodestone::detail {

/// What is made when it is first asked for, by whichever thread that is; the others wait.
template <class T>
class OnFirstUse {
 public:
  /// `make()` returns a T.
  template <class Make>
  const T& get(const Make& make) {
    std::call_once(once_, [&] { value_.emplace(make()); });
    return *value_;
  }

 private:
  std::once_flag once_;
  std::optional<T> value_;
};

}  // namespace lodestone::detail

#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::detail {

struct ChildLimits {
  std::chrono::seconds processor_time{10};
  std::size_t memory_bytes = std::size_t{1} << 30;  ///< beyond what this process has now
};

/// Runs `work` in a process of its own and returns the bytes that it makes: for code that may not end, take any amount
/// of memory or crash. What else `work` changes is lost. Errors: those of `work`; LimitExceeded where it meets a limit,
/// Malformed where a signal ends it, Unreadable where the system gives no process. Pre: `work` needs no lock that
/// another thread may hold.
Result<std::vector<std::byte>> run_in_child(const std::function<Result<std::vector<std::byte>>()>& work,
                                            const ChildLimits& limits);

}  // namespace lodestone::detail

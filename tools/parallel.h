#pragma once

#include <cstddef>
#include <functional>

namespace lodestone::tool {

/// Calls `job(i)` for every i below `count`, on as many threads as the machine has cores, and returns when all are done.
/// Jobs start in ascending order. What they write must not overlap; then the result does not depend on the threads.
void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& job);

}  // namespace lodestone::tool

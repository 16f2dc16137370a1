#pragma once

#include <atomic>
#include <cstddef>

// Operators new and delete that count, for programs that support/counted_memory.cpp is linked to.

namespace lodestone::test {

extern std::atomic<std::size_t> live_bytes;        ///< allocated and not given back
extern std::atomic<std::size_t> peak_bytes;        ///< the most of them; a test sets it back
extern std::atomic<std::size_t> allocation_count;  ///< ever

}  // namespace lodestone::test

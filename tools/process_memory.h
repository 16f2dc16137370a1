#pragma once

#include <cstdint>

namespace lodestone::tool {

/// Returns the most memory this process has had resident so far, in bytes; 0 where the system does not say.
std::uint64_t peak_memory_bytes();

}  // namespace lodestone::tool

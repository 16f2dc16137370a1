#define XXH_INLINE_ALL  // Header-only, so that no library has to be found again by who links to lodestone.
#include <xxhash.h>

#include "stream/stream_layout.h"

namespace lodestone::detail {

std::uint64_t checksum64(std::span<const std::byte> bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/result.h>

#include "base/json.h"

namespace lodestone::detail {

/// Decodes a bufferView compressed by EXT_meshopt_compression (or its KHR successor); `extension` is its object.
/// Errors: LimitExceeded where the view says it holds more than `max_bytes`.
Result<std::vector<std::byte>> decode_meshopt(const Json& extension, std::span<const std::byte> compressed,
                                              std::size_t max_bytes, std::string_view where);

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <string_view>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/ids.h>
#include <lodestone/core/result.h>

namespace lodestone::detail {

/// Checks that `Index` can number so many entries. Errors: LimitExceeded, with `what` there are too many of.
inline Result<void> check_index_limit(std::string_view what, std::size_t count, std::size_t limit = kNoIndex) {
  if (count <= limit) return {};
  return fail(ErrorCode::LimitExceeded,
              text(count, " ", what, " are more than the ", limit, " that 32-bit indices can number"));
}

}  // namespace lodestone::detail

#pragma once

#include <lodestone/core/result.h>

namespace lodestone::detail {

/// What cancelled work ends with.
inline tl::unexpected<Error> cancelled() { return fail(ErrorCode::Cancelled, "cancelled"); }

}  // namespace lodestone::detail

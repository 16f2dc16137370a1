#pragma once

#include <cmath>

#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// Whether no coordinate is infinite or no number.
inline bool is_finite(const Vec3f& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace lodestone::detail

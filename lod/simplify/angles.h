#pragma once

#include <cstddef>

namespace lodestone::detail {

/// Writes the angle of each (cosine, sine), both times any positive number, with sine ≥ 0: radians, 0 … π; 0 where both
/// are 0. At most 3·10⁻¹⁰ from the true one.
void angles(std::size_t count, const double* cosine, const double* sine, double* angle);

}  // namespace lodestone::detail

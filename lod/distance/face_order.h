#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "distance/triangle.h"

namespace lodestone::detail {

/// How many neighbouring runs of an order make up the next larger one.
inline constexpr std::size_t kRunWidth = 4;

/// Returns an order of triangles in which every run of 4^k, counted from the start, fits well into one box, whichever
/// way that is turned. Cost: O(n log n).
std::vector<Index> compact_order(std::span<const Triangle> triangles);

}  // namespace lodestone::detail

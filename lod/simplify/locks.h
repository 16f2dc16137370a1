#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/lod/simplify_options.h>

namespace lodestone::detail {

/// Returns which vertices the options keep, by vertex; empty where that is none. Copies of a vertex are locked
/// together.
std::vector<std::uint8_t> find_locked(const Connectivity& connectivity, const SimplifyOptions& options);

}  // namespace lodestone::detail

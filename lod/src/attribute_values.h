#pragma once

#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns an attribute's components as floats, element after element; normalized integers in [0, 1] or [−1, 1]. What is
/// not finite becomes 0: it can neither be compared nor averaged.
std::vector<float> attribute_values(const Attribute& attribute);

}  // namespace lodestone::detail

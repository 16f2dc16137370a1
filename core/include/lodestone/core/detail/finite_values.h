#pragma once

#include <cmath>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns an attribute's components as floats; what is not finite becomes 0: it can neither be compared nor averaged.
inline std::vector<float> finite_values(const Attribute& attribute) {
  std::vector<float> values = attribute_values(attribute);
  for (float& value : values)
    if (!std::isfinite(value)) value = 0;
  return values;
}

}  // namespace lodestone::detail

#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/io/compact_stream.h>

#include "codec/attribute_spec.h"

namespace lodestone::detail {

/// Chooses how an attribute is coded, and its grid.
AttributeSpec choose_spec(const Attribute& attribute, const CompactOptions& options);

/// Returns the numbers of all its elements.
std::vector<std::int32_t> rounded(const Attribute& attribute, const AttributeSpec& spec);

}  // namespace lodestone::detail

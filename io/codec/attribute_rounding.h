#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/io/compact_stream.h>

#include "codec/attribute_spec.h"

namespace lodestone::detail {

/// Chooses how attributes are coded, and their grids.
std::vector<AttributeSpec> choose_specs(std::span<const Attribute> attributes, const CompactOptions& options);

/// Returns the numbers of all elements, by attribute.
std::vector<std::vector<std::int32_t>> rounded(std::span<const Attribute> attributes,
                                               std::span<const AttributeSpec> specs);

}  // namespace lodestone::detail

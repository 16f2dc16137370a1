#pragma once

#include <optional>
#include <string>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns a sentence about positions so far from the origin, for the mesh's size, that floats are more than a
/// thousandth of it apart there; nothing where floats hold the shape.
std::optional<std::string> coarse_floats(const Mesh& mesh);

}  // namespace lodestone::detail

#pragma once

#include <lodestone/core/mesh.h>
#include <lodestone/core/removal.h>

namespace lodestone::detail {

/// Returns an upper bound of the two-sided distance between a star and the faces that replaced it, in mesh units.
double displacement_bound(const Mesh& mesh, const RemovalRecord& record);

}  // namespace lodestone::detail

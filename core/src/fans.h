#pragma once

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Gives every fan but the first of a vertex a vertex of its own, at the same position, and copies of its wedges.
///
/// A fan is what hangs together at a vertex: neighbouring faces of one sheet. Where several sheets share an edge, it
/// finds out which faces belong together. No fan meets an edge or a position of its ring twice.
void cut_into_fans(Mesh& mesh, AssemblyReport& report);

}  // namespace lodestone::detail

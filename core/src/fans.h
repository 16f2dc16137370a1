#pragma once

#include <span>

#include <lodestone/core/assemble.h>
#include <lodestone/core/detail/edges.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Gives every fan but the first of a vertex a vertex of its own, at the same position, and copies of its wedges.
///
/// A fan is what hangs together at a vertex: neighbouring faces of one sheet. Where several sheets share an edge, it
/// finds out which faces belong together. No fan meets an edge or a position of its ring twice.
/// Pre: `halves` are the mesh's sorted edges.
void cut_into_fans(Mesh& mesh, std::span<const HalfEdge> halves, AssemblyReport& report);

}  // namespace lodestone::detail

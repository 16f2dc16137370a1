#pragma once

#include <cstddef>
#include <span>

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Turns faces so that neighbours at edges of two faces wind alike, wherever they can; returns how many.
///
/// No two neighbours that wind alike part, and where normals at the faces of an edge speak for both as they are, both
/// stay. Which side of a region is its front normals say, where there are any; else nine tenths of its faces, or that
/// it is round or closed and looks outwards, or most of its faces. Pre: `halves` are the mesh's sorted edges.
std::size_t make_winding_coherent(Mesh& mesh, std::span<const HalfEdge> halves);

}  // namespace lodestone::detail

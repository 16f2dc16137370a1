#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>

namespace lodestone::bench {

/// Triangles as any simplifier gives them: positions alone, in doubles because some compute in them.
struct Surface {
  std::vector<Vec3> points;                 ///< may hold points that no face uses
  std::vector<std::array<Index, 3>> faces;  ///< indices into `points`, counter-clockwise from outside
};

/// Assembles triangles without their attributes and materials, so that only what is open in space is a border. Nothing
/// where they cannot be.
Mesh positions_of(TriangleSoup soup);

/// Returns the faces of a mesh over its vertices; attributes and materials are left out.
Surface surface_of(const Mesh& mesh);

/// Returns the diagonal of the box around the points that faces use, mesh units.
double diagonal_of(const Surface& surface);

}  // namespace lodestone::bench

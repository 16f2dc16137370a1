#pragma once

#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>

namespace lodestone {

/// The discrete curvatures of one vertex, integrated over its share of the surface, each smooth sector by itself: the
/// angle across a crease is none of the surface's curvature. (K̄ knows no such angles: of a crease vertex it is the sum
/// of its sectors' π − Σα, of a corner that differs by a constant.)
///
/// Source: Kim, Hong, Kim: Mesh simplification with discrete curvature error metric, section 2.
struct VertexCurvature {
  double gaussian = 0;  ///< K̄ = 2π − Σα (π − Σα at a border), radians
  double mean = 0;      ///< H̄ = ¼ Σ |e|·|β|, absolute, mesh units
  double area = 0;      ///< S: a third of each face around; the shares sum to the mesh's area
};

/// Returns the sum of absolute principal curvatures, integrated: 2H̄ if K̄ ≥ 0, else 2√(H̄² − K̄·S), mesh units.
///
/// With K̄ < 0 the root is always real. With K̄ ≥ 0 the value is 2H̄ also where H̄² < K̄·S, where the two principal
/// curvatures would be complex (it happens on discrete surfaces only): their sum is real all the same.
double principal_curvature(const VertexCurvature& curvature);

/// Returns the curvatures of one vertex; zero where it has no faces.
VertexCurvature vertex_curvature(const Mesh& mesh, const Connectivity& connectivity, Index vertex);

/// Returns the curvatures of every vertex; zero for a vertex without faces. Shapes: mesh.vertex_count() entries.
std::vector<VertexCurvature> vertex_curvatures(const Mesh& mesh, const Connectivity& connectivity);

}  // namespace lodestone

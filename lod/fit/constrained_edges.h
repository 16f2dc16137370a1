#pragma once

#include <array>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// An edge of a mesh: its faces' corners that face it, where there are two that agree; else kNoIndex. Where sheets lie
/// on one another it has two such corners in each.
struct MeshEdge {
  std::array<Index, 2> vertices{};
  std::array<Index, 2> corners{kNoIndex, kNoIndex};
  std::vector<std::array<Index, 2>> layers;  ///< the corners in further sheets
  bool constrained = false;                  ///< border, seam, material border, or faces on more sides than two
  bool stays = false;                        ///< see turn_edges
};

/// Lists the edges of any mesh, sorted by their vertices. Unlike `Connectivity` it takes meshes that are not manifold.
std::vector<MeshEdge> list_edges(const Mesh& mesh);

}  // namespace lodestone::detail

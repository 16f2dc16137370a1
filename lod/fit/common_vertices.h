#pragma once

#include <vector>

#include <lodestone/core/detail/position_index.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// The places of a mesh's vertices, some of which are those of its levels, too: from these one knows without a search
/// where on the one surface the other is near.
class CommonVertices {
 public:
  /// The original outlives it.
  explicit CommonVertices(const Mesh& original);

  /// Returns for each vertex of the original a face of the level at the vertex of both that is the fewest edges away;
  /// kNoIndex where no edges lead to one. Pre: no vertex of the level has moved.
  std::vector<Index> faces_near(const Mesh& level) const;

  /// Returns for each face of the level the first face of the original at one of its corners; kNoIndex for none. Pre:
  /// as above.
  std::vector<Index> faces_at(const Mesh& level) const;

 private:
  void spread(std::vector<Index>& of_place) const;

  const Mesh& original_;
  PositionIndex index_;
  std::vector<Index> place_;  // by vertex: the first one there
};

}  // namespace lodestone::detail

#pragma once

#include <memory>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Finds the attributes that the original has where a level's vertices have gone.
class AttributeLookup {
 public:
  /// `original` outlives it.
  explicit AttributeLookup(const Mesh& original);
  ~AttributeLookup();

  /// Gives the wedges of a level whose vertices have moved the attributes that the original has where they went, each
  /// on its own side of every seam. Vertices whose textures would turn a face over go back to where they were.
  ///
  /// `before` is the level as it was: the same wedges at vertices of the original.
  void look_up(const Mesh& before, Mesh& level) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;  // none where there are no attributes
};

}  // namespace lodestone::detail

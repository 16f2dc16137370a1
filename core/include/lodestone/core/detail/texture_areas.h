#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// The areas of triangles in a mesh's textures: the attributes TEXCOORD_n of two components, in the mesh's order.
class TextureAreas {
 public:
  explicit TextureAreas(const Mesh& mesh);

  static bool is_texture(const Attribute& attribute) {
    return attribute.name.starts_with("TEXCOORD_") && attribute.component_count == 2;
  }

  std::size_t count() const { return coordinates_.size(); }

  /// A texture's coordinates, two for each wedge.
  const std::vector<float>& coordinates(std::size_t texture) const { return coordinates_[texture]; }

  /// Returns twice the signed area of three wedges in a texture.
  double area(std::size_t texture, Index a, Index b, Index c) const;

  /// The same for a face of a mesh with these wedges.
  double area(std::size_t texture, const Mesh& mesh, Index face) const {
    const Index* wedge = &mesh.corner_wedge[3 * std::size_t{face}];
    return area(texture, wedge[0], wedge[1], wedge[2]);
  }

 private:
  std::vector<std::vector<float>> coordinates_;
};

}  // namespace lodestone::detail

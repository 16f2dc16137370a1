#include <lodestone/core/detail/texture_areas.h>

#include <lodestone/core/detail/finite_values.h>

namespace lodestone::detail {

TextureAreas::TextureAreas(const Mesh& mesh) {
  for (const Attribute& attribute : mesh.attributes)
    if (is_texture(attribute)) coordinates_.push_back(finite_values(attribute));
}

double TextureAreas::area(std::size_t texture, Index a, Index b, Index c) const {
  const std::vector<float>& values = coordinates_[texture];
  const auto at = [&](Index wedge, std::size_t i) { return static_cast<double>(values[2 * std::size_t{wedge} + i]); };
  return (at(b, 0) - at(a, 0)) * (at(c, 1) - at(a, 1)) - (at(b, 1) - at(a, 1)) * (at(c, 0) - at(a, 0));
}

}  // namespace lodestone::detail

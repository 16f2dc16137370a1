#include "simplify/creases.h"

#include <lodestone/core/detail/texture_areas.h>

namespace lodestone::detail {

void mark_creases(const Mesh& mesh, const SimplifyOptions& options, Connectivity& connectivity) {
  const TextureAreas textures(mesh);
  if (!options.crease_angle && textures.count() == 0) return;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    const Index across = connectivity.opposite(corner);
    if (across == kNoIndex || across < corner) continue;
    const Index face = face_of_corner(corner);
    const Index other = face_of_corner(across);
    bool hard = options.crease_angle &&
                angle_between(area_vector(mesh, face), area_vector(mesh, other)) > *options.crease_angle;
    for (std::size_t t = 0; t < textures.count() && !hard; ++t)
      hard = textures.area(t, mesh, face) * textures.area(t, mesh, other) < 0;
    if (hard) connectivity.mark_crease(corner);
  }
}

}  // namespace lodestone::detail

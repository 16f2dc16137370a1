#include "creases.h"

#include <cmath>

#include "attribute_cost.h"

namespace lodestone::detail {
namespace {

double texture_area(const Mesh& mesh, const AttributeCost& attributes, std::size_t texture, Index face) {
  const Index* wedge = &mesh.corner_wedge[3 * std::size_t{face}];
  return attributes.texture_area(texture, wedge[0], wedge[1], wedge[2]);
}

}  // namespace

void mark_creases(const Mesh& mesh, const SimplifyOptions& options, Connectivity& connectivity) {
  const AttributeCost attributes(mesh, {0, 0, 0, 0, 0});
  if (!options.crease_angle && attributes.texture_count() == 0) return;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    const Index across = connectivity.opposite(corner);
    if (across == kNoIndex || across < corner) continue;
    const Index face = face_of_corner(corner);
    const Index other = face_of_corner(across);
    bool hard = options.crease_angle &&
                angle_between(area_vector(mesh, face), area_vector(mesh, other)) > *options.crease_angle;
    for (std::size_t t = 0; t < attributes.texture_count() && !hard; ++t)
      hard = texture_area(mesh, attributes, t, face) * texture_area(mesh, attributes, t, other) < 0;
    if (hard) connectivity.mark_crease(corner);
  }
}

}  // namespace lodestone::detail

#include "surface.h"

#include <algorithm>
#include <utility>

namespace lodestone::bench {

Mesh positions_of(TriangleSoup soup) {
  soup.attributes.clear();
  soup.face_material.clear();
  auto assembled = assemble(soup);
  return assembled ? std::move(assembled->mesh) : Mesh{};
}

Surface surface_of(const Mesh& mesh) {
  Surface surface;
  surface.points.reserve(mesh.vertex_count());
  for (const Vec3f& p : mesh.positions) surface.points.emplace_back(p);
  surface.faces.reserve(mesh.face_count());
  for (Index corner = 0; corner < mesh.corner_wedge.size(); corner += 3) {
    surface.faces.push_back(
        {mesh.corner_vertex(corner), mesh.corner_vertex(corner + 1), mesh.corner_vertex(corner + 2)});
  }
  return surface;
}

double diagonal_of(const Surface& surface) {
  if (surface.faces.empty()) return 0;
  Vec3 low = surface.points[surface.faces.front()[0]];
  Vec3 high = low;
  for (const auto& face : surface.faces) {
    for (const Index i : face) {
      const Vec3& p = surface.points[i];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return length(high - low);
}

}  // namespace lodestone::bench

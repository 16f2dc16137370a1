#include <lodestone/core/mesh.h>

#include <algorithm>
#include <limits>

namespace lodestone {

std::size_t component_bytes(ComponentType type) {
  switch (type) {
    case ComponentType::Int8:
    case ComponentType::UInt8:
      return 1;
    case ComponentType::Int16:
    case ComponentType::UInt16:
      return 2;
    case ComponentType::UInt32:
    case ComponentType::Float32:
      return 4;
  }
  return 0;
}

Box bounding_box(const Mesh& mesh) {
  if (mesh.face_count() == 0) return {};
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Box box{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    const Vec3 p = mesh.corner_position(corner);
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

double surface_area(const Mesh& mesh) {
  double area = 0;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); corner += 3) {
    const Vec3 a = mesh.corner_position(corner);
    area += 0.5 * length(cross(mesh.corner_position(corner + 1) - a, mesh.corner_position(corner + 2) - a));
  }
  return area;
}

}  // namespace lodestone

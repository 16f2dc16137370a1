#include "face_guard.h"

#include <algorithm>

namespace lodestone::detail {
namespace {

constexpr double kMinCosine = 0.5;  // of the angle a face may turn by in one go
constexpr double kMinShape = 0.02;  // a face's height over its longest edge

double shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)});
  return longest > 0 ? length(cross(b - a, c - a)) / longest : 0;
}

bool keeps_direction(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& before) {
  const Vec3 normal = cross(b - a, c - a);
  return dot(normal, before) > kMinCosine * length(normal) * length(before);
}

}  // namespace

bool is_upright(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& before) {
  return keeps_direction(a, b, c, before) && shape(a, b, c) > kMinShape;
}

void keep_faces_upright(const Mesh& mesh, std::vector<Vec3f>& positions) {
  for (bool changed = true; changed;) {
    changed = false;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const Index v[3] = {mesh.corner_vertex(3 * f), mesh.corner_vertex(3 * f + 1), mesh.corner_vertex(3 * f + 2)};
      const bool moved = std::any_of(v, v + 3, [&](Index i) { return !(positions[i] == mesh.positions[i]); });
      if (!moved) continue;
      const Vec3 a = mesh.corner_position(3 * f);
      const Vec3 b = mesh.corner_position(3 * f + 1);
      const Vec3 c = mesh.corner_position(3 * f + 2);
      const Vec3 p(positions[v[0]]), q(positions[v[1]]), r(positions[v[2]]);
      // What was a sliver may stay one, as long as it gets no worse.
      const double new_shape = shape(p, q, r);
      if (keeps_direction(p, q, r, cross(b - a, c - a)) && (new_shape > kMinShape || new_shape >= shape(a, b, c)))
        continue;
      for (const Index i : v) positions[i] = mesh.positions[i];
      changed = true;
    }
  }
}

}  // namespace lodestone::detail

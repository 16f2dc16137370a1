// Nearest faces by neighbours, by scans and by an index, against all faces.

#include "distance/target_surface.h"

#include <cmath>
#include <vector>

#include <lodestone/lod/deviation.h>

#include "distance/patch_bound.h"
#include "support/catch.h"
#include "support/deviations.h"
#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

using detail::NearFace;
using detail::TargetSurface;

constexpr std::size_t kPoints = 60;  // more than are scanned for before an index is made

/// Points on a mesh's faces and up to a tenth of its size away from them.
std::vector<Vec3> points_near(const Mesh& mesh, std::uint64_t seed) {
  Random random(seed);
  const double size = 0.1 * bounding_box(mesh).diagonal();
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vec3 aside{size * random.signed_unit(), size * random.signed_unit(), size * random.signed_unit()};
    points.push_back(point_on_face(mesh, static_cast<Index>(random.below(mesh.face_count())), i) + aside);
  }
  return points;
}

/// Calls `visit(mesh, opposite corners)` for each family of shapes that has faces.
template <class Visit>
void for_each_surface(const Visit& visit) {
  for (const NamedShape& shape : all_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    INFO(shape.name);
    visit(mesh, detail::opposite_corners(mesh));
  }
}

}  // namespace

TEST_CASE("the nearest face is as near as that of all, with an index or without, and whatever the hint") {
  for_each_surface([](const Mesh& mesh, const std::vector<Index>& opposite) {
    const SurfaceIndex index(mesh);
    TargetSurface by_itself(mesh, opposite), by_index(mesh, opposite, index);
    Random random(3);
    for (const Vec3& p : points_near(mesh, 1)) {
      const double least = distance_to_all(p, mesh);
      const Index hint = random.below(2) == 0 ? kNoIndex : static_cast<Index>(random.below(mesh.face_count()));
      for (TargetSurface* surface : {&by_itself, &by_index}) {
        const NearFace found = surface->nearest(p, hint);
        CHECK(found.distance == Approx(least).epsilon(1e-9).margin(1e-12));
        CHECK(surface->distance_to_face(p, found.face) == found.distance);
      }
    }
  });
}

TEST_CASE("going from face to face never ends farther than it began, and says how far that is") {
  for_each_surface([](const Mesh& mesh, const std::vector<Index>& opposite) {
    const TargetSurface surface(mesh, opposite);
    Random random(4);
    for (const Vec3& p : points_near(mesh, 2)) {
      const auto start = static_cast<Index>(random.below(mesh.face_count()));
      const NearFace found = surface.near(p, start);
      CHECK(found.distance == surface.distance_to_face(p, found.face));
      CHECK(found.distance <= surface.distance_to_face(p, start));
    }
  });
}

TEST_CASE("on a convex shape going from face to face finds the nearest from anywhere for points outside") {
  const Mesh mesh = mesh_of(icosphere(3, 0, 1));
  const std::vector<Index> opposite = detail::opposite_corners(mesh);
  const TargetSurface surface(mesh, opposite);
  Random random(5);
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vec3 p = normalized(Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()}) * 1.2;
    const NearFace found = surface.near(p, static_cast<Index>(random.below(mesh.face_count())));
    nearest += found.distance <= distance_to_all(p, mesh) + 1e-12 ? 1 : 0;
  }
  CHECK(nearest == kPoints);
}

}  // namespace lodestone::test

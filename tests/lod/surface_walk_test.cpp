#include "distance/surface_walk.h"

#include <cmath>
#include <limits>

#include <lodestone/lod/deviation.h>
#include <lodestone/lod/surface_index.h>

#include "support/catch.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using detail::SurfaceWalk;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kSingle = 1e-6;  // more than rounding to single precision does on shapes of size 1

Vec3 at(const Mesh& mesh, const SurfaceWalk::Place& place) {
  Vec3 point;
  for (Index k = 0; k < 3; ++k) point += mesh.corner_position(3 * place.face + k) * place.on.weights[k];
  return point;
}

}  // namespace

TEST_CASE("a walk comes no farther away, and ends where no face that meets the point has a nearer one") {
  for (const TriangleSoup& soup : {icosphere(3, 0.1, 2), torus(24, 16), terrain(20, 3)}) {
    const Mesh mesh = mesh_of(soup);
    const SurfaceWalk walk(mesh);
    const SurfaceIndex index(mesh);
    Random random(7);
    for (int trial = 0; trial < 100; ++trial) {
      const auto start = static_cast<Index>(random.below(mesh.face_count()));
      const Vec3 point{1.5 * random.signed_unit(), 1.5 * random.signed_unit(), 1.5 * random.signed_unit()};
      const SurfaceWalk::Place place = walk.nearest_from(point, start);
      const double distance = std::sqrt(place.on.squared_distance);
      const Vec3 nearest = at(mesh, place);
      CHECK(std::abs(length(point - nearest) - distance) < kSingle);
      CHECK(std::abs(index.distance_to_face(point, place.face) - distance) < kSingle);
      CHECK(distance <= index.distance_to_face(point, start) + kSingle);
      for (Index f = 0; f < mesh.face_count(); ++f)
        if (index.distance_to_face(nearest, f) < 1e-12) CHECK(index.distance_to_face(point, f) > distance - kSingle);
    }
  }
}

TEST_CASE("from a face nearby a walk finds the nearest point of a smooth surface") {
  for (const TriangleSoup& soup : {icosphere(4, 0, 0), torus(48, 32)}) {
    const Mesh mesh = mesh_of(soup);
    const SurfaceWalk walk(mesh);
    const SurfaceIndex index(mesh);
    std::size_t right = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const Vec3 point = point_on_face(mesh, f, 3) + normalized(area_vector(mesh, f)) * 0.02;
      const Index start = face_of_corner((3 * f + 21) % static_cast<Index>(mesh.corner_wedge.size()));
      const double nearest = index.nearest(point, kUnlimited).distance;
      right += std::sqrt(walk.nearest_from(point, start).on.squared_distance) <= nearest + kSingle ? 1 : 0;
    }
    CHECK(right > 99 * mesh.face_count() / 100);
  }
}

TEST_CASE("a walk crosses where sheets were cut apart, and sees vertices where they have moved") {
  // Two unit squares side by side that share positions, not vertices.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
  mesh.wedge_vertex = {0, 1, 2, 3, 4, 5, 6, 7};
  mesh.corner_wedge = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  SurfaceWalk walk(mesh);
  CHECK(walk.nearest_from({1.9, 0.2, 1}, 1).face == 2);
  for (Vec3f& p : mesh.positions) p.x += 4;
  walk.update(mesh);
  CHECK(walk.nearest_from({5.9, 0.2, 1}, 1).on.squared_distance == 1);
}

}  // namespace lodestone::test

// Bounds by patches against distances to all faces.

#include "distance/patch_bound.h"

#include <array>
#include <cmath>
#include <vector>

#include <lodestone/lod/surface_index.h>

#include "distance/triangle.h"
#include "support/catch.h"
#include "support/deviations.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using detail::PatchBound;
using TriangleCorners = std::array<Vec3, 3>;

constexpr std::size_t kTriangles = 60;
constexpr std::size_t kPoints = 25;  // of a triangle

/// Near a face: its corners moved by up to a share of its size, which may fold it, or let it lie over others.
TriangleCorners triangle_near(const Mesh& mesh, Index face, double share, Random& random) {
  TriangleCorners corners;
  const double size = share * length(mesh.corner_position(3 * face) - mesh.corner_position(3 * face + 1));
  for (Index k = 0; k < 3; ++k)
    corners[k] = mesh.corner_position(3 * face + k) +
                 Vec3{size * random.signed_unit(), size * random.signed_unit(), size * random.signed_unit()};
  return corners;
}

/// The largest distance that points of a triangle have from a mesh.
double sampled_distance(const TriangleCorners& t, const Mesh& mesh) {
  double largest = 0;
  for (std::size_t k = 0; k < kPoints; ++k)
    largest = std::max(largest, distance_to_all(detail::point_on_triangle(t[0], t[1], t[2], k), mesh));
  for (const Vec3& corner : t) largest = std::max(largest, distance_to_all(corner, mesh));
  return largest;
}

/// A triangle in the plane z = height.
TriangleCorners level_triangle(double x, double y, double size, double height) {
  return {Vec3{x, y, height}, Vec3{x + size, y, height}, Vec3{x, y + size, height}};
}

}  // namespace

TEST_CASE("no point of a triangle is farther from a surface, or from the patch, than the bound by patches") {
  std::size_t bounded = 0;
  for (const NamedShape& shape : all_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    INFO(shape.name);
    const std::vector<Index> opposite = detail::opposite_corners(mesh);
    PatchBound patch(mesh, opposite);
    Random random(5);
    const double diagonal = bounding_box(mesh).diagonal(), slack = 1e-6 * diagonal;
    for (std::size_t i = 0; i < kTriangles; ++i) {
      const auto face = static_cast<Index>(random.below(mesh.face_count()));
      const double share = std::array{0.05, 0.5, 2.0}[i % 3];
      const TriangleCorners triangle = triangle_near(mesh, face, share, random);
      const double bound = patch.bound(triangle, face, diagonal, slack);
      if (bound == kInfinity) continue;
      ++bounded;
      CHECK(sampled_distance(triangle, mesh) <= bound + 1e-9 * diagonal);
      const std::vector<Index> faces(patch.patch().begin(), patch.patch().end());
      CHECK(sampled_distance(triangle, pick_faces(mesh, faces)) <= bound + 1e-9 * diagonal);
    }
  }
  CHECK(bounded > 500);
}

TEST_CASE("a bound by a patch is the height of a plane, wherever the search starts and however many faces lie under") {
  const Mesh plane = mesh_of(grid(12, 0, 1));
  const Box box = bounding_box(plane);
  const double width = box.high.x - box.low.x, cell = width / 12, slack = 1e-6 * width;
  const std::vector<Index> opposite = detail::opposite_corners(plane);
  PatchBound patch(plane, opposite);
  Random random(6);
  const SurfaceIndex index(plane);
  for (const double size : {0.1 * cell, cell, 3 * cell, 6 * cell})
    for (int i = 0; i < 50; ++i) {
      const double room = width - size - 2 * slack, height = 0.3 * cell * random.unit();
      const double x = box.low.x + slack + room * random.unit(), y = box.low.y + slack + room * random.unit();
      const TriangleCorners triangle = level_triangle(x, y, size, box.low.z + height);
      const Index start = index.nearest(triangle[random.below(3)], kInfinity).face;
      CAPTURE(size, x, y, start);
      CHECK(patch.bound(triangle, start, cell, slack) == Approx(height + slack).margin(1e-6 * width));
      CHECK(patch.bound(triangle, start, 0.5 * height, slack) == kInfinity);
    }
}

TEST_CASE("what reaches over a border, or a hole, has no bound by a patch") {
  const Mesh plane = mesh_of(grid(12, 0, 1));
  const Box box = bounding_box(plane);
  const double width = box.high.x - box.low.x, cell = width / 12, slack = 1e-6 * width;
  const auto gone = static_cast<Index>(plane.face_count() / 2 + 7);  // a face in the middle
  std::vector<Index> kept;
  for (Index f = 0; f < plane.face_count(); ++f)
    if (f != gone) kept.push_back(f);
  const Mesh holed = pick_faces(plane, kept);
  const TriangleCorners missing = {plane.corner_position(3 * gone), plane.corner_position(3 * gone + 1),
                                   plane.corner_position(3 * gone + 2)};
  const std::vector<Index> opposite = detail::opposite_corners(holed);
  PatchBound patch(holed, opposite);
  const Vec3 middle = (missing[0] + missing[1] + missing[2]) * (1.0 / 3);
  for (Index start = 0; start < holed.face_count(); ++start) {
    // Over the whole hole, a part of it, all around it, and beyond the border.
    CHECK(patch.bound(missing, start, cell, slack) == kInfinity);
    CHECK(patch.bound(level_triangle(middle.x, middle.y, 0.05 * cell, box.low.z), start, cell, slack) == kInfinity);
    CHECK(patch.bound(level_triangle(middle.x - cell, middle.y - cell, 4 * cell, box.low.z), start, cell, slack) ==
          kInfinity);
    CHECK(patch.bound(level_triangle(box.high.x - cell, box.low.y + cell, 2 * cell, box.low.z), start, cell, slack) ==
          kInfinity);
  }
}

}  // namespace lodestone::test

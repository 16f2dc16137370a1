#include <lodestone/core/curvature.h>

#include <numbers>
#include <numeric>

#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

struct Curved {
  Mesh mesh;
  Connectivity connectivity;
  std::vector<VertexCurvature> curvatures;
};

Curved curved(const TriangleSoup& soup) {
  Mesh mesh = mesh_of(soup);
  auto connectivity = Connectivity::build(mesh);
  REQUIRE(connectivity);
  auto curvatures = vertex_curvatures(mesh, *connectivity);
  return {std::move(mesh), std::move(*connectivity), std::move(curvatures)};
}

double total(const Curved& shape, double VertexCurvature::*part) {
  return std::accumulate(shape.curvatures.begin(), shape.curvatures.end(), 0.0,
                         [&](double sum, const VertexCurvature& c) { return sum + c.*part; });
}

constexpr double kPi = std::numbers::pi;

}  // namespace

TEST_CASE("area shares sum to the area of the mesh") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Curved c = curved(shape.soup);
    CHECK(total(c, &VertexCurvature::area) == Approx(surface_area(c.mesh)).epsilon(1e-12));
  }
}

TEST_CASE("Gaussian curvature sums to 2π times the Euler characteristic, borders included") {
  for (const NamedShape& shape : manifold_shapes()) {
    INFO(shape.name);
    const Curved c = curved(shape.soup);
    CHECK(total(c, &VertexCurvature::gaussian) == Approx(2 * kPi * euler_characteristic(c.connectivity)).margin(1e-6));
  }
}

TEST_CASE("curvatures of a cube: a right angle at each edge, π/2 at each corner") {
  const Curved c = curved(cube(4));
  const double side = bounding_box(c.mesh).high.x - bounding_box(c.mesh).low.x;
  // ¼ |e| β to each end of every edge: ½ · 12 sides · π/2 in all.
  CHECK(total(c, &VertexCurvature::mean) == Approx(0.5 * 12 * side * kPi / 2));
  int corners = 0;
  for (const VertexCurvature& v : c.curvatures) {
    const bool flat = std::abs(v.gaussian) < 1e-9;
    const bool corner = std::abs(v.gaussian - kPi / 2) < 1e-9;
    CHECK((flat || corner));
    corners += corner ? 1 : 0;
  }
  CHECK(corners == 8);
}

TEST_CASE("the angle across a crease is no curvature of its sectors") {
  const Mesh mesh = mesh_of(cube(4));
  auto connectivity = Connectivity::build(mesh);
  REQUIRE(connectivity);
  const std::vector<VertexCurvature> before = vertex_curvatures(mesh, *connectivity);
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    const Vec3 normal = area_vector(mesh, face_of_corner(corner));
    const Vec3 beyond = area_vector(mesh, face_of_corner(connectivity->opposite(corner)));
    if (angle_between(normal, beyond) > 0.1) connectivity->mark_crease(corner);
  }
  const std::vector<VertexCurvature> after = vertex_curvatures(mesh, *connectivity);
  for (std::size_t v = 0; v < after.size(); ++v) {
    CHECK(std::abs(after[v].mean) < 1e-9);
    CHECK(after[v].gaussian == before[v].gaussian);
    CHECK(after[v].area == before[v].area);
  }
}

TEST_CASE("curvatures of a sphere approach those of the smooth one") {
  const Curved c = curved(icosphere(4, 0, 1));
  CHECK(total(c, &VertexCurvature::gaussian) == Approx(4 * kPi));
  // The integral of the mean curvature 1/r over a unit sphere is 4π.
  CHECK(total(c, &VertexCurvature::mean) == Approx(4 * kPi).epsilon(0.02));
  for (const VertexCurvature& v : c.curvatures) CHECK(v.gaussian / v.area == Approx(1).epsilon(0.25));
}

TEST_CASE("a flat grid is not curved") {
  for (const VertexCurvature& v : curved(grid(6, 0, 1)).curvatures) {
    CHECK(v.mean == Approx(0).margin(1e-12));
    CHECK(principal_curvature(v) == Approx(0).margin(1e-6));
  }
}

TEST_CASE("curvatures scale as an angle and as a length") {
  TriangleSoup soup = icosphere(2, 0.1, 7);
  const Curved small = curved(soup);
  for (Vec3f& p : soup.positions) p = {p.x * 4, p.y * 4, p.z * 4};
  const Curved large = curved(soup);
  for (std::size_t v = 0; v < small.curvatures.size(); ++v) {
    CHECK(large.curvatures[v].gaussian == Approx(small.curvatures[v].gaussian).margin(1e-9));
    CHECK(large.curvatures[v].mean == Approx(4 * small.curvatures[v].mean));
    CHECK(large.curvatures[v].area == Approx(16 * small.curvatures[v].area));
    CHECK(principal_curvature(large.curvatures[v]) == Approx(4 * principal_curvature(small.curvatures[v])));
  }
}

TEST_CASE("the principal curvatures' sum is real also where they would be complex") {
  CHECK(principal_curvature({1, 0.1, 1}) == Approx(0.2));  // H̄² < K̄·S
  CHECK(principal_curvature({1, 3, 1}) == Approx(6));      // both positive: 2H̄
  CHECK(principal_curvature({-1, 0, 1}) == Approx(2));     // a saddle: 2√(H̄² − K̄S)
  CHECK(principal_curvature({-1, 2, 5}) == Approx(2 * 3));
}

}  // namespace lodestone::test

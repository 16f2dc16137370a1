// The nearest-point structure against all faces, the narrowed maximum against dense samples, and both against Metro.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/deviation.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/deviations.h"
#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

Vec3f random_point(Random& random, double size) {
  const auto coordinate = [&] { return static_cast<float>(size * random.signed_unit()); };
  return {coordinate(), coordinate(), coordinate()};
}

/// Triangles between random points; some of them needles, segments and points.
Mesh random_soup(std::uint64_t seed, int face_count, double size) {
  Random random(seed);
  std::vector<Vec3f> positions;
  std::vector<Index> corners;
  for (int f = 0; f < face_count; ++f) {
    Vec3f a = random_point(random, size), b = random_point(random, size), c = random_point(random, size);
    const std::uint64_t kind = random.below(8);
    if (kind == 0) c = b;
    if (kind == 1) b = c = a;
    if (kind == 2) c = {b.x + static_cast<float>(1e-6 * size), b.y, b.z};
    for (const Vec3f& p : {a, b, c}) {
      corners.push_back(static_cast<Index>(positions.size()));
      positions.push_back(p);
    }
  }
  return raw_mesh(std::move(positions), std::move(corners));
}

Mesh scaled(Mesh mesh, double factor) {
  for (Vec3f& p : mesh.positions) {
    p = {static_cast<float>(p.x * factor), static_cast<float>(p.y * factor), static_cast<float>(p.z * factor)};
  }
  return mesh;
}

bool near(double value, double expected, double relative, double absolute = 0) {
  return std::abs(value - expected) <= relative * std::abs(expected) + absolute;
}

/// The mesh turned so that none of its directions is an axis', and made longer along one of them before.
Mesh turned(Mesh mesh, double stretch = 1) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (Vec3f& p : mesh.positions) {
    const Vec3 q(p.x, p.y, p.z * stretch);
    const double x = q.x * c - q.y * s, y = q.x * s + q.y * c;
    p = {static_cast<float>(x), static_cast<float>(y * c - q.z * s), static_cast<float>(y * s + q.z * c)};
  }
  return mesh;
}

/// A bar whose sides are strips of `n` parts; on two sides each strip is two fans around its ends.
Mesh fanned_bar(int n) {
  std::vector<Vec3f> positions;
  std::vector<Index> corners;
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k < 4; ++k)
      positions.push_back({k == 1 || k == 2 ? 1.0f : 0.0f, k > 1 ? 1.0f : 0.0f, static_cast<float>(i)});
  }
  const auto at = [](int k, int i) { return static_cast<Index>(4 * i + k % 4); };
  for (int k = 0; k < 4; ++k) {
    const bool fans = k % 2 == 0;
    for (int i = 0; i < n; ++i) {
      corners.insert(corners.end(), {at(k, i), at(k, i + 1), at(k + 1, fans ? n : i)});
      corners.insert(corners.end(), {at(k, fans ? 0 : i + 1), at(k + 1, i + 1), at(k + 1, i)});
    }
  }
  return turned(raw_mesh(std::move(positions), std::move(corners)));
}

/// A disc triangulated from one end to the other as its outline goes round.
Mesh zigzag_disc(int n) {
  std::vector<Vec3f> positions;
  std::vector<Index> corners;
  for (int i = 0; i < n; ++i) {
    positions.push_back({static_cast<float>(std::cos(6.283 * i / n)), static_cast<float>(std::sin(6.283 * i / n)), 0});
  }
  for (int low = 0, high = n - 1; high - low > 1; (low + high) % 2 == 0 ? ++low : --high) {
    const int next = (low + high) % 2 == 0 ? low + 1 : high - 1;
    for (const int v : {low, next, high}) corners.push_back(static_cast<Index>(v));
  }
  return turned(raw_mesh(std::move(positions), std::move(corners)));
}

/// Two square sheets that meet at an edge, each of n × n cells; `angle` lies between them, radians.
Mesh folded_sheet(int n, double angle) {
  std::vector<Vec3f> positions;
  std::vector<Index> corners;
  for (int j = -n; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double along = std::abs(j) / static_cast<double>(n), turned = j < 0 ? angle : 0;
      positions.push_back({static_cast<float>(i) / static_cast<float>(n), static_cast<float>(along * std::cos(turned)),
                           static_cast<float>(along * std::sin(turned))});
    }
  const auto at = [n](int i, int j) { return static_cast<Index>((j + n) * (n + 1) + i); };
  for (int j = -n; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      corners.insert(corners.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      corners.insert(corners.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return raw_mesh(std::move(positions), std::move(corners));
}

/// The mesh with each coordinate rounded to a multiple of `step`.
Mesh rounded(Mesh mesh, float step) {
  for (Vec3f& p : mesh.positions) {
    p = {std::round(p.x / step) * step, std::round(p.y / step) * step, std::round(p.z / step) * step};
  }
  return mesh;
}

/// The mesh and a vertex that no face uses, by which it has not the vertices of any other.
Mesh with_spare_vertex(Mesh mesh) {
  mesh.positions.push_back(mesh.positions.front());
  return mesh;
}

/// The mesh several times over, each time moved up by `step`.
Mesh stacked(const Mesh& mesh, int count, float step) {
  std::vector<Vec3f> positions;
  std::vector<Index> corners;
  for (int i = 0; i < count; ++i) {
    const Index first = static_cast<Index>(positions.size());
    for (const Vec3f& p : mesh.positions) positions.push_back({p.x, p.y, p.z + step * static_cast<float>(i)});
    for (Index c = 0; c < mesh.corner_wedge.size(); ++c) corners.push_back(first + mesh.corner_vertex(c));
  }
  return raw_mesh(std::move(positions), std::move(corners));
}

/// The mesh, one triangle more at the end.
Mesh with_triangle(const Mesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  std::vector<Vec3f> positions = mesh.positions;
  std::vector<Index> corners;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) corners.push_back(mesh.corner_vertex(corner));
  for (const Vec3f& p : {a, b, c}) {
    corners.push_back(static_cast<Index>(positions.size()));
    positions.push_back(p);
  }
  return raw_mesh(std::move(positions), std::move(corners));
}

/// The mesh and as many segments along its edges as it has faces.
Mesh with_segments(const Mesh& mesh) {
  std::vector<Index> corners;
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) corners.push_back(mesh.corner_vertex(c));
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3) {
    corners.insert(corners.end(), {corners[c], corners[c + 1], corners[c + 1]});
  }
  return raw_mesh(mesh.positions, std::move(corners));
}

/// How many nodes and faces a query visits on average, over points on a mesh or a share of `size` away from it.
double mean_visits(const Mesh& mesh, double distance) {
  constexpr std::size_t kQueries = 3000;
  const SurfaceIndex index(mesh);
  double sum = 0;
  for (std::size_t i = 0; i < kQueries; ++i) {
    const Index face = static_cast<Index>(i * mesh.face_count() / kQueries);
    const Vec3 p = point_on_face(mesh, face, i) + normalized(area_vector(mesh, face)) * distance;
    sum += static_cast<double>(index.nearest(p, kInfinity).visits);
  }
  return sum / kQueries;
}

}  // namespace

TEST_CASE("the nearest point is that of all faces, whatever the scale and the hint") {
  const double size = GENERATE(1.0, 1e-20, 1e15);
  Random random(11);
  for (std::uint64_t seed = 0; seed < (kReduced ? 4 : 20); ++seed) {
    const Mesh mesh = random_soup(seed, 1 + static_cast<int>(random.below(90)), size);
    const SurfaceIndex index(mesh);
    for (int i = 0; i < 50; ++i) {
      const double reach = i % 5 == 0 ? 1e4 : 1.5;
      const Vec3 p = i % 7 == 0 ? mesh.corner_position(static_cast<Index>(random.below(mesh.corner_wedge.size())))
                                : Vec3(random_point(random, reach * size));
      const SurfaceIndex::Hit hit = index.nearest(p, kInfinity);
      REQUIRE(hit.face < mesh.face_count());
      CHECK(near(hit.distance, distance_to_all(p, mesh), 1e-9, 1e-12 * size));
      CHECK(near(length(p - hit.point), hit.distance, 0, 1e-12 * size));
      CHECK(index.distance_to_face(p, hit.face) == hit.distance);

      const SurfaceIndex::Hit hinted = index.nearest(p, kInfinity, static_cast<Index>(random.below(mesh.face_count())));
      CHECK(hinted.face == hit.face);
      CHECK(hinted.distance == hit.distance);
      CHECK(index.nearest(p, hit.distance * 1.001, hit.face).face == hit.face);
      if (hit.distance > 0) {
        CHECK(index.nearest(p, hit.distance * 0.999).face == kNoIndex);
        CHECK(index.nearest(p, hit.distance * 0.999, hit.face).distance == kInfinity);
      }
    }
  }
}

TEST_CASE("points searched together find what each finds by itself, wherever they lie") {
  for (const double scale : {1e-30, 1e-3, 1.0, 1e12, 1e30}) {
    const Mesh mesh = random_soup(5, 300, scale);
    const SurfaceIndex index(mesh);
    Random random(23);
    std::vector<Vec3> points;
    std::vector<SurfaceIndex::Hit> hits;
    for (const std::size_t count : {0, 1, 7, 8, 9, 100}) {
      points.clear();
      hits.clear();
      for (std::size_t i = 0; i < count; ++i) {
        points.emplace_back(random_point(random, random.below(4) == 0 ? 1e5 * scale : 1.5 * scale));
        const bool hinted = random.below(2) == 0;
        hits.push_back({0, {}, hinted ? static_cast<Index>(random.below(mesh.face_count())) : kNoIndex, 0});
      }
      index.nearest(points, hits);
      for (std::size_t i = 0; i < count; ++i) {
        const SurfaceIndex::Hit alone = index.nearest(points[i], kInfinity);
        CHECK(hits[i].face == alone.face);
        CHECK(hits[i].point == alone.point);
        CHECK(hits[i].distance == alone.distance);
      }
    }
  }
  std::vector<SurfaceIndex::Hit> hits(3);
  SurfaceIndex(Mesh{}).nearest(std::vector<Vec3>(3), hits);
  for (const SurfaceIndex::Hit& hit : hits) CHECK((hit.face == kNoIndex && hit.distance == kInfinity));
}

TEST_CASE("equally near faces: the lowest is named") {
  const Mesh mesh = mesh_of(grid(8, 0, 1));
  const SurfaceIndex index(mesh);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    for (Index corner = 3 * f; corner < 3 * f + 3; ++corner) {
      const SurfaceIndex::Hit hit = index.nearest(mesh.corner_position(corner), kInfinity, f);
      CHECK(hit.distance == 0);
      CHECK(hit.face <= f);
    }
  }
}

TEST_CASE("a query costs about as much whatever the shape of the faces is and wherever they are") {
  const Mesh terrain_mesh = mesh_of(terrain(64, 1));  // The well-shaped one, of as many faces as the others.
  const double terrain_size = bounding_box(terrain_mesh).diagonal();
  const std::vector<std::pair<std::string, Mesh>> meshes = {
      {"cone", turned(mesh_of(fan(8000, 0.2)))},
      {"flat fan", turned(mesh_of(fan(8000, 0)))},
      {"rod", turned(mesh_of(cylinder(4000, 1)), 20)},
      {"spindle", turned(mesh_of(double_cone(4000)), 20)},
      {"fanned bar", fanned_bar(1000)},
      {"zigzag disc", zigzag_disc(8000)},
      {"eight in one place", stacked(mesh_of(terrain(23, 1)), 8, 0)},
      {"eight close together", stacked(mesh_of(terrain(23, 1)), 8, 1e-3f)},
      {"far from the origin", shifted(scaled(terrain_mesh, 1e3), 5e5f, 5e6f, 0)},
      {"segments", with_segments(mesh_of(terrain(45, 1)))},
  };
  // These are looked at as closely as without their last face.
  const std::vector<std::pair<std::string, Mesh>> unlike = {
      {"a far outlier", with_triangle(terrain_mesh, {1e7f, 0, 0}, {1e7f, 1, 0}, {1e7f, 0, 1})},
      {"a triangle under all", with_triangle(terrain_mesh, {1e4f, 0, -1}, {1e4f, 1e4f, -1}, {-1e4f, -1e4f, -1})},
  };
  for (const double share : {0.0, 1e-4, 1e-3}) {
    const double limit = 12 * mean_visits(terrain_mesh, share * terrain_size);
    const auto check = [&](const std::string& name, const Mesh& mesh, double size) {
      INFO(name << ", " << share << " away");
      CHECK(mean_visits(mesh, share * size) < limit);
    };
    for (const auto& [name, mesh] : meshes) check(name, mesh, bounding_box(mesh).diagonal());
    for (const auto& [name, mesh] : unlike) check(name, mesh, terrain_size);
  }
}

TEST_CASE("an empty surface has no nearest point") {
  const SurfaceIndex index{Mesh{}};
  CHECK(index.empty());
  const SurfaceIndex::Hit hit = index.nearest({1, 2, 3}, kInfinity);
  CHECK(hit.face == kNoIndex);
  CHECK(hit.distance == kInfinity);
}

TEST_CASE("empty meshes deviate by infinity from others and not from each other") {
  const Mesh mesh = mesh_of(tetrahedron()), empty;
  CHECK(measure_deviation(Mesh{}, Mesh{}).maximum_bound() == 0);
  CHECK(measure_deviation(mesh, Mesh{}).forward.mean == kInfinity);
  CHECK(measure_deviation(Mesh{}, mesh).maximum() == kInfinity);
  CHECK(measure_maximum(MeasuredSurface(mesh), MeasuredSurface(empty), {}).maximum() == kInfinity);
}

TEST_CASE("every shape equals itself") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    DeviationOptions options;
    options.sample_count = 500;
    const Deviation deviation = measure_deviation(mesh, mesh, options);
    CHECK(deviation.maximum_bound() <= allowed(0, options, bounding_box(mesh).diagonal()));
    CHECK(deviation.forward.mean <= 1e-7);
    CHECK(deviation.mean_normal_angle < 0.01);
  }
}

TEST_CASE("parallel planes and concentric spheres deviate as computed by hand") {
  const Mesh plane = mesh_of(grid(5, 0, 1));
  const Deviation planes = measure_deviation(plane, shifted(mesh_of(grid(7, 0, 1)), 0, 0, 0.25F));
  for (const OneSidedDeviation& side : {planes.forward, planes.backward}) {
    CHECK(near(side.maximum, 0.25, 1e-6));
    CHECK(near(side.maximum_bound, 0.25, 0.0011));
    CHECK(near(side.mean, 0.25, 1e-6));
    CHECK(near(side.rms, 0.25, 1e-6));
  }
  CHECK(near(planes.mean_normal_angle, 0, 0, 1e-9));

  const Mesh sphere = mesh_of(icosphere(3, 0, 1));
  const Deviation spheres = measure_deviation(sphere, scaled(sphere, 1.5));
  CHECK(near(spheres.backward.maximum, 0.5, 0.01));
  CHECK(near(spheres.forward.mean, 0.5, 0.02));

  // A unit square against its half: the far edge is 0.5 away, the mean over the square 0.125, and the rms √(1/24); the
  // edges weigh 2 % and are a third farther away.
  const Mesh square = raw_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
  const Mesh half = raw_mesh({{0, 0, 0}, {0.5F, 0, 0}, {0.5F, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
  const Deviation halved = measure_deviation(square, half);
  CHECK(near(halved.forward.maximum, 0.5, 1e-6));
  CHECK(near(halved.forward.mean, 0.125, 0.01));
  CHECK(near(halved.forward.rms, std::sqrt(1.0 / 24), 0.01));
  CHECK(halved.backward.maximum_bound < 1e-6);
}

TEST_CASE("mean and rms are over vertices, edges and faces as Metro counts them") {
  // A square in two faces that is in the other surface, and one as large, finely meshed, that is 0.5 above it.
  const Index n = 100;
  std::vector<Vec3f> positions = {{2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0}};
  std::vector<Index> corners = {0, 1, 2, 0, 2, 3};
  for (Index y = 0; y <= n; ++y) {
    for (Index x = 0; x <= n; ++x) {
      if (x < n && y < n) {
        const Index v = static_cast<Index>(positions.size());
        corners.insert(corners.end(), {v, v + 1, v + n + 2, v, v + n + 2, v + n + 1});
      }
      positions.push_back({static_cast<float>(x) / n, static_cast<float>(y) / n, 0.5F});
    }
  }
  positions.push_back({9, 9, 9});  // No face uses it, so that it is not a part of the surface.
  const Mesh mesh = raw_mesh(positions, corners);
  const Mesh plane = raw_mesh({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {0, 1, 2});

  const double count = 10.0 * (2 * n * n + 2);
  const double fine_vertices = (n + 1.0) * (n + 1.0);
  const double rest = count - fine_vertices - 4;
  const double per_length = std::sqrt(rest / 2);
  const double fine_edges = per_length * (2 * (n + 1) + n * std::sqrt(2.0));
  const double coarse_edges = per_length * (4 + std::sqrt(2.0));
  const double fine_share = (fine_vertices + fine_edges + (rest - fine_edges - coarse_edges) / 2) / count;
  CHECK(fine_share > 0.7);  // Half by area.
  for (const std::size_t taken : {1000, 200'000, 400'000}) {
    DeviationOptions options;
    options.sample_count = taken;
    const Deviation found = measure_deviation(mesh, plane, options);
    const double tolerance = taken < 10'000 ? 0.01 : 0.0005;
    CHECK(near(found.forward.mean, 0.5 * fine_share, tolerance));
    CHECK(near(found.forward.rms, 0.5 * std::sqrt(fine_share), tolerance));
    CHECK(near(found.mean_normal_angle, 0, 0, 1e-9));
    CHECK(near(static_cast<double>(found.forward.sample_count), static_cast<double>(taken), 0.06));
  }
}

TEST_CASE("mean and rms of needles near those of their area, even where Metro would take samples of edges alone") {
  // Thousands of thin ridges: at edges the distance is the least or the largest, between them every one in between. The
  // vertices, a tenth of Metro's samples, count as ever.
  const Index n = kReduced ? 2000 : 5000;
  std::vector<Vec3f> ridges;
  std::vector<Index> corners;
  for (Index i = 0; i <= 2 * n; ++i) {
    const float x = static_cast<float>(i) / static_cast<float>(2 * n);
    ridges.insert(ridges.end(), {{x, 0, i % 2 == 0 ? 0.F : 1e-6F}, {x, 1, i % 2 == 0 ? 0.F : 1e-6F}});
  }
  for (Index i = 0; i < 2 * n; ++i)
    corners.insert(corners.end(), {2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 1, 2 * i + 2, 2 * i + 3});
  const Mesh plane = raw_mesh({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {0, 1, 2});
  const Deviation found = measure_deviation(raw_mesh(ridges, corners), plane);
  CHECK(near(found.forward.mean, 0.5e-6, 0.02));
  CHECK(near(found.forward.rms, 1e-6 / std::sqrt(3.0), 0.05));  // over edges alone: 0.22 more
}

TEST_CASE("the normal angle is over the area alone, even where Metro would take no samples in faces") {
  // A fan of slivers in the plane, and a face as large that stands upright: half of the area is at a right angle.
  const Index n = 2000;
  std::vector<Vec3f> positions = {{0, 0, 0}};
  std::vector<Index> corners;
  for (Index i = 0; i <= n; ++i) positions.push_back({1, static_cast<float>(i) / n, 0});
  for (Index i = 1; i <= n; ++i) corners.insert(corners.end(), {0, i, i + 1});
  const Index first = static_cast<Index>(positions.size());
  positions.insert(positions.end(), {{0, -1, 0}, {1, -1, 0}, {1, -1, 1}});
  corners.insert(corners.end(), {first, first + 1, first + 2});
  const Mesh plane = raw_mesh({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {0, 1, 2});
  const Deviation found = measure_deviation(raw_mesh(positions, corners), plane);
  CHECK(near(found.mean_normal_angle, std::acos(0.0) / 2, 0.001));
}

TEST_CASE("a flat sheet costs few queries however its triangles lie") {
  const Mesh fine = mesh_of(grid(40, 0, 1));
  const Mesh coarse = mesh_of(grid(7, 0, 2));
  DeviationOptions options;
  options.budget = 2000;
  const Deviation deviation = measure_maximum(MeasuredSurface(fine), MeasuredSurface(coarse), options);
  CHECK(deviation.maximum_bound() <= allowed(0, options, bounding_box(fine).diagonal()) + 1e-7);
}

TEST_CASE("an edge costs few queries however sharp it is") {
  for (const double angle : {0.1, 0.5, 1.2, 1.6, 2.5}) {
    INFO("sheets at " << angle);
    const Mesh fine = folded_sheet(23, angle), coarse = folded_sheet(6, angle);
    DeviationOptions options;
    options.budget = 500;
    const Deviation deviation = measure_maximum(MeasuredSurface(fine), MeasuredSurface(coarse), options);
    CHECK(deviation.maximum_bound() <= allowed(0, options, bounding_box(fine).diagonal()) + 1e-6);
  }
}

TEST_CASE("that faces correspond makes no difference to what is measured") {
  for (const NamedShape& shape : all_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    INFO(shape.name);
    const double diagonal = bounding_box(mesh).diagonal();
    DeviationOptions options;
    options.sample_count = kReduced ? 300 : 3000;
    for (const double step : {1e-3, 0.2}) {
      const Mesh same = rounded(mesh, static_cast<float>(step * diagonal)), other = with_spare_vertex(same);
      const Deviation with = measure_deviation(mesh, same, options), without = measure_deviation(mesh, other, options);
      CHECK(overlap(with, without));
      CHECK(with.maximum_bound() <= allowed(with.maximum(), options, diagonal));
      for (const auto side : {&Deviation::forward, &Deviation::backward}) {
        CHECK((with.*side).mean == Approx((without.*side).mean).epsilon(1e-9).margin(1e-12 * diagonal));
        CHECK((with.*side).rms == Approx((without.*side).rms).epsilon(1e-9).margin(1e-12 * diagonal));
      }
    }
  }
}

TEST_CASE("the maximum lies between its bounds on meshes of every sort") {
  Random random(5);
  DeviationOptions options;
  options.sample_count = 100;
  for (std::uint64_t seed = 0; seed < (kReduced ? 5 : 40); ++seed) {
    INFO("seed " << seed);
    options.relative_tolerance = seed % 2 == 0 ? 0.001 : 0.1;
    const Mesh a = random_soup(seed, 1 + static_cast<int>(random.below(30)), 1);
    const Mesh b = random_soup(seed + 1000, 1 + static_cast<int>(random.below(30)), 1);
    const Deviation deviation = measure_deviation(a, b, options);
    const double diagonal = std::max(bounding_box(a).diagonal(), bounding_box(b).diagonal());
    check_contains(deviation.forward, sample_supremum(a, b, 40));
    check_contains(deviation.backward, sample_supremum(b, a, 40));
    CHECK(deviation.forward.maximum_bound <= allowed(deviation.forward.maximum, options, diagonal));
    CHECK(deviation.backward.maximum_bound <= allowed(deviation.backward.maximum, options, diagonal));

    const Deviation both = measure_maximum(MeasuredSurface(a), MeasuredSurface(b), options);
    CHECK(overlap(both, deviation));
    CHECK(both.maximum_bound() <= allowed(both.maximum(), options, diagonal));
  }
}

TEST_CASE("the maximum lies between its bounds on levels of every shape") {
  for (const NamedShape& shape : all_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    const double diagonal = bounding_box(mesh).diagonal();
    for (const double cell : {0.03, 0.1, 0.3}) {
      INFO(shape.name << " in cells of " << cell);
      const Mesh level = clustered(mesh, cell * diagonal);
      if (level.face_count() == 0) continue;
      DeviationOptions options;
      options.sample_count = 100;
      const SampledSupremum forward = sample_supremum(mesh, level, 6), backward = sample_supremum(level, mesh, 12);
      for (const double tolerance : {0.001, 0.1}) {
        options.relative_tolerance = tolerance;
        options.each_way = tolerance < 0.1;  // as levels are measured at small efforts
        const Deviation deviation = measure_deviation(mesh, level, options);
        check_contains(deviation.forward, forward);
        check_contains(deviation.backward, backward);
        CHECK(deviation.maximum_bound() <= allowed(deviation.maximum(), options, diagonal));
      }
    }
  }
}

TEST_CASE("a spent budget gives an honest bound") {
  const Mesh a = mesh_of(icosphere(2, 0.1, 3));
  const Mesh b = mesh_of(icosphere(2, 0.1, 4));
  const SampledSupremum forward = sample_supremum(a, b, 30);
  for (const std::size_t budget : {0, 1, 10, 100}) {
    DeviationOptions options;
    options.sample_count = 10;
    options.relative_tolerance = 1e-9;
    options.budget = budget;
    check_contains(measure_deviation(a, b, options).forward, forward);
  }
}

TEST_CASE("measuring that is cancelled at any call makes no other, and its bound is wide, but true") {
  const Mesh a = mesh_of(icosphere(kReduced ? 2 : 4, 0.1, 3));
  const Mesh b = mesh_of(icosphere(kReduced ? 2 : 4, 0.1, 4));
  const double found = measure_deviation(a, b).forward.maximum;
  bool ends = false;
  for (int last = 1; !ends; last = 2 * last + 1) {
    CAPTURE(last);
    int calls = 0;
    double done = 0;
    DeviationOptions options;
    options.sample_count = 20'000;
    options.progress = [&](double share) {
      done = share;
      return ++calls < last;
    };
    const Deviation deviation = measure_deviation(a, b, options);
    CHECK(deviation.forward.maximum_bound >= found);
    CHECK(calls <= last);
    ends = calls < last;
    if (ends) CHECK(done == Approx(1));
  }
}

TEST_CASE("enough is enough") {
  const Mesh a = mesh_of(icosphere(3, 0.02, 3));
  const Mesh b = mesh_of(icosphere(2, 0.02, 4));
  const Deviation tight = measure_maximum(MeasuredSurface(a), MeasuredSurface(b), {});
  const Deviation loose = measure_maximum(MeasuredSurface(a), MeasuredSurface(b), {}, 2 * tight.maximum());
  CHECK(overlap(tight, loose));
  CHECK(loose.maximum_bound() <= 2 * tight.maximum() * (1 + 1e-9));
}

TEST_CASE("the same meshes give the same numbers, and swapped ones the sides swapped") {
  const Mesh a = mesh_of(torus(20, 12));
  const Mesh b = clustered(a, 0.2);
  DeviationOptions options;
  options.sample_count = 5000;
  const Deviation first = measure_deviation(a, b, options);
  const Deviation again = measure_deviation(a, b, options);
  const Deviation swapped = measure_deviation(b, a, options);
  CHECK(first.forward.mean == again.forward.mean);
  CHECK(first.forward.maximum_bound == again.forward.maximum_bound);
  CHECK(first.mean_normal_angle == again.mean_normal_angle);
  CHECK(first.forward.mean == swapped.backward.mean);
  CHECK(first.backward.rms == swapped.forward.rms);
  CHECK(first.backward.maximum == swapped.forward.maximum);
}

TEST_CASE("mean, rms and maximum agree with Metro") {
  const auto table = model("metro/metro.tsv");
  LODESTONE_SKIP_UNLESS(table, "no models: set LODESTONE_DATA to their folder");
  std::ifstream file(*table);
  std::string line;
  std::getline(file, line);
  int rows = 0;
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string original, simplified;
    OneSidedDeviation forward, backward;
    fields >> original >> simplified >> forward.maximum >> forward.mean >> forward.rms >> backward.maximum >>
        backward.mean >> backward.rms;
    INFO(simplified);
    const auto a = model(original), b = model("metro/" + simplified);
    REQUIRE(fields);
    REQUIRE(a);
    REQUIRE(b);
    const Deviation found = measure_deviation(read_mesh(*a).value().mesh, read_mesh(*b).value().mesh);
    const auto check_agrees = [&](const OneSidedDeviation& ours, const OneSidedDeviation& metros) {
      CHECK(near(ours.mean, metros.mean, 0.1));
      CHECK(near(ours.rms, metros.rms, 0.1));
      CHECK(ours.maximum_bound >= metros.maximum * (1 - 1e-5));
      CHECK(ours.maximum >= metros.maximum * 0.98);
      CHECK(ours.maximum_bound <= ours.maximum * 1.0011);
    };
    check_agrees(found.forward, forward);
    check_agrees(found.backward, backward);
    ++rows;
  }
  CHECK(rows >= 4);
}

TEST_CASE("faces in exactly one place cost a search no more than one of them, and all are found") {
  constexpr Index kCopies = 3000;
  Mesh mesh;
  for (Index copy = 0; copy < kCopies; ++copy)
    for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}) {
      mesh.corner_wedge.push_back(static_cast<Index>(mesh.positions.size()));
      mesh.wedge_vertex.push_back(static_cast<Index>(mesh.positions.size()));
      mesh.positions.push_back(p);
    }
  const SurfaceIndex index(mesh);
  for (const Vec3& p : {Vec3{0.2, 0.2, 1}, Vec3{-1, -1, 0}, Vec3{0.3, 0.3, 0}}) {
    const SurfaceIndex::Hit hit = index.nearest(p, kInfinity, kCopies - 1);
    CHECK(hit.face == 0);
    CHECK(hit.visits < 10);
    std::vector<Index> faces;
    index.within(p, hit.distance, faces);
    REQUIRE(faces.size() == kCopies);
    for (Index face = 0; face < kCopies; ++face) CHECK(faces[face] == face);
    CHECK(index.distance_to_face(p, kCopies / 2) == hit.distance);
  }
}

}  // namespace lodestone::test

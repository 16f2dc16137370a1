#include <lodestone/core/vec.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const double kPi = std::acos(-1.0);

Vec3 random_vector(Random& random, double size = 1) {
  return Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()} * size;
}

bool near(const Vec3& a, const Vec3& b, double absolute) { return length(a - b) <= absolute; }

/// The three corners of every face of every family.
std::vector<std::array<Vec3, 3>> triangles() {
  std::vector<std::array<Vec3, 3>> all;
  for (const NamedShape& shape : all_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    for (Index c = 0; c < mesh.corner_wedge.size(); c += 3)
      all.push_back({mesh.corner_position(c), mesh.corner_position(c + 1), mesh.corner_position(c + 2)});
  }
  return all;
}

}  // namespace

TEST_CASE("sums and products by numbers are those of a vector space") {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_vector(random), b = random_vector(random), c = random_vector(random);
    const double s = random.signed_unit();
    CHECK(a + b == b + a);
    CHECK(a - b == a + -1.0 * b);
    CHECK(a - a == Vec3{});
    CHECK(near((a + b) + c, a + (b + c), 1e-15));
    CHECK(near((a + b) * s, a * s + b * s, 1e-15));
    CHECK(s * a == a * s);
    CHECK(2 * a == a + a);
    Vec3 sum = a;
    CHECK(&(sum += b) == &sum);
    CHECK(sum == a + b);
  }
}

TEST_CASE("the dot product is symmetric, linear, and the squared length of a vector with itself") {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_vector(random), b = random_vector(random), c = random_vector(random);
    CHECK(dot(a, b) == dot(b, a));
    CHECK(dot(a + b, c) == Approx(dot(a, c) + dot(b, c)).margin(1e-15));
    CHECK(dot(a, a) == squared_length(a));
    CHECK(length(a) == Approx(std::hypot(a.x, a.y, a.z)));
    CHECK(std::abs(dot(a, b)) <= length(a) * length(b) * (1 + 1e-15));
    CHECK(length(a + b) <= length(a) + length(b) + 1e-15);
  }
  CHECK(dot({1, 2, 3}, {4, 5, 6}) == 32);
}

TEST_CASE(
    "the cross product turns counter-clockwise, is perpendicular to both, and as long as the parallelogram is large") {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_vector(random), b = random_vector(random), c = random_vector(random);
    const Vec3 n = cross(a, b);
    CHECK(n == -1.0 * cross(b, a));
    CHECK(cross(a, a) == Vec3{});
    CHECK(std::abs(dot(n, a)) < 1e-15);
    CHECK(std::abs(dot(n, b)) < 1e-15);
    CHECK(squared_length(n) == Approx(squared_length(a) * squared_length(b) - dot(a, b) * dot(a, b)).margin(1e-14));
    CHECK(dot(n, c) == Approx(dot(cross(b, c), a)).margin(1e-15));
    CHECK(length(cross(a, cross(b, c)) + cross(b, cross(c, a)) + cross(c, n)) < 1e-14);  // Jacobi's identity
  }
  CHECK(cross({1, 0, 0}, {0, 1, 0}) == Vec3{0, 0, 1});
  CHECK(cross({0, 1, 0}, {0, 0, 1}) == Vec3{1, 0, 0});
}

TEST_CASE("a normalized vector has length 1 and the direction it had, at any size") {
  Random random(4);
  for (const double size : {1e-140, 1e-30, 1.0, 1e30, 1e140})
    for (int i = 0; i < 50; ++i) {
      const Vec3 a = random_vector(random, size);
      const Vec3 unit = normalized(a);
      CHECK(length(unit) == Approx(1).epsilon(1e-15));
      CHECK(near(unit * length(a), a, 1e-15 * size));
      CHECK(near(normalized(unit), unit, 1e-15));
      CHECK(near(normalized(-3 * a), -1.0 * unit, 1e-15));
    }
}

TEST_CASE("what has no direction is normalized to zero, everything else is not") {
  const std::vector<Vec3> without = {{},           {0, -0.0, 0},   {kInfinity, 0, 0},   {1, -kInfinity, 2},
                                     {kNan, 0, 0}, {1, kNan, 1e9}, {kInfinity, kNan, 0}};
  for (const Vec3& a : without) {
    CHECK_FALSE(has_direction(a));
    CHECK(normalized(a) == Vec3{});
  }
  const float least = std::numeric_limits<float>::denorm_min(), most = std::numeric_limits<float>::max();
  for (const Vec3f& p : {Vec3f{least, 0, 0}, Vec3f{0, -least, least}, Vec3f{most, most, -most}, Vec3f{0, 0, 1}}) {
    CHECK(has_direction(Vec3(p)));
    CHECK(length(normalized(Vec3(p))) == Approx(1));
  }
}

TEST_CASE("an angle is that by which a vector was turned, near 0 and π, too, whatever the lengths") {
  Random random(5);
  for (const double angle : {0.0, 1e-12, 1e-7, 0.1, 1.0, kPi / 2, 2.0, kPi - 1e-7, kPi})
    for (int i = 0; i < 20; ++i) {
      const Vec3 a = normalized(random_vector(random));
      const Vec3 across = normalized(cross(a, random_vector(random)));
      const Vec3 b = a * std::cos(angle) + across * std::sin(angle);
      CHECK(angle_between(a, b) == Approx(angle).epsilon(1e-9).margin(1e-15));
      CHECK(angle_between(b, a) == Approx(angle).epsilon(1e-9).margin(1e-15));
      CHECK(angle_between(a * 1e-30, b * 1e40) == Approx(angle).epsilon(1e-9).margin(1e-15));
    }
  CHECK(angle_between({}, {1, 2, 3}) == 0);
  CHECK(angle_between({1, 2, 3}, {}) == 0);
}

TEST_CASE("the angles of every face add up to π, and its sides keep the law of cosines") {
  std::size_t count = 0;
  for (const auto& [a, b, c] : triangles()) {
    if (!has_direction(cross(b - a, c - a))) continue;
    const double at_a = angle_between(b - a, c - a), at_b = angle_between(c - b, a - b),
                 at_c = angle_between(a - c, b - c);
    CHECK(at_a + at_b + at_c == Approx(kPi));
    const double opposite = length(c - b), left = length(b - a), right = length(c - a);
    CHECK(opposite * opposite == Approx(left * left + right * right - 2 * left * right * std::cos(at_a)).margin(1e-12));
    ++count;
  }
  CHECK(count > 1000);
}

TEST_CASE("points are stored in twelve bytes and computed with as they are") {
  static_assert(sizeof(Vec3f) == 12);
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Vec3f p{static_cast<float>(random.signed_unit()), static_cast<float>(random.signed_unit()), 1e-40F};
    const Vec3 q(p);
    CHECK(Vec3f{static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)} == p);
    CHECK(Vec3f{p.x, p.y, 1} != p);
    CHECK(Vec3{q.x, q.y + 1, q.z} != q);
  }
  CHECK(Vec3f{} == Vec3f{0, 0, 0});
  CHECK(Vec3{} == Vec3(Vec3f{}));
}

}  // namespace lodestone::test

#include "support/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "support/random.h"
#include "support/soup_building.h"

namespace lodestone::test {
namespace {

/// Adds columns × rows squares over points that the caller numbers: `point(i, j)`, i along columns, j along rows.
template <class Point>
void add_squares(TriangleSoup& soup, int columns, int rows, Point point) {
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      add_square(soup, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
}

/// Makes a sheet of columns × rows squares; `position(i, j)` returns an array of x, y, z.
template <class Position>
TriangleSoup sheet(int columns, int rows, Position position) {
  TriangleSoup soup;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const std::array<double, 3> p = position(i, j);
      add_point(soup, p[0], p[1], p[2]);
    }
  }
  add_squares(soup, columns, rows, [&](int i, int j) { return static_cast<Index>(j * (columns + 1) + i); });
  return soup;
}

Attribute float_attribute(const char* name, int component_count, std::span<const float> values) {
  Attribute attribute;
  attribute.name = name;
  attribute.component_count = static_cast<std::uint8_t>(component_count);
  attribute.data.resize(values.size_bytes());
  std::memcpy(attribute.data.data(), values.data(), values.size_bytes());
  return attribute;
}

/// A point of a cube's side: (u, v) on the side, w along its normal. Equal points of two sides get equal coordinates.
std::array<double, 3> cube_point(int side, double u, double v) {
  const double w = side % 2 == 0 ? 1 : 0;
  // On odd sides u and v change places, so that both of an axis' sides wind outwards.
  if (side % 2 == 1) std::swap(u, v);
  const int axis = side / 2;
  std::array<double, 3> p{};
  p[axis] = w;
  p[(axis + 1) % 3] = u;
  p[(axis + 2) % 3] = v;
  return p;
}

void add_cube_side(TriangleSoup& soup, int side, int n) {
  const auto first = static_cast<Index>(soup.positions.size());
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const auto p = cube_point(side, double(i) / n, double(j) / n);
      add_point(soup, p[0], p[1], p[2]);
    }
  }
  add_squares(soup, n, n, [&](int i, int j) { return first + static_cast<Index>(j * (n + 1) + i); });
}

/// Splits each triangle into four, with new points on the unit sphere.
void subdivide_sphere(TriangleSoup& soup) {
  std::map<std::pair<Index, Index>, Index> midpoints;
  const auto midpoint = [&](Index a, Index b) {
    const auto key = std::minmax(a, b);
    if (const auto found = midpoints.find(key); found != midpoints.end()) return found->second;
    const Vec3 m = normalized(Vec3(soup.positions[a]) + Vec3(soup.positions[b]));
    return midpoints[key] = add_point(soup, m.x, m.y, m.z);
  };
  const std::vector<Index> old = std::exchange(soup.indices, {});
  for (std::size_t t = 0; t < old.size(); t += 3) {
    const Index a = old[t], b = old[t + 1], c = old[t + 2];
    const Index ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    add_triangle(soup, a, ab, ca);
    add_triangle(soup, b, bc, ab);
    add_triangle(soup, c, ca, bc);
    add_triangle(soup, ab, bc, ca);
  }
}

TriangleSoup icosahedron() {
  TriangleSoup soup;
  const double g = (1 + std::sqrt(5.0)) / 2;
  for (const auto& p : {std::array{-1.0, g, 0.0},
                        {1.0, g, 0.0},
                        {-1.0, -g, 0.0},
                        {1.0, -g, 0.0},
                        {0.0, -1.0, g},
                        {0.0, 1.0, g},
                        {0.0, -1.0, -g},
                        {0.0, 1.0, -g},
                        {g, 0.0, -1.0},
                        {g, 0.0, 1.0},
                        {-g, 0.0, -1.0},
                        {-g, 0.0, 1.0}}) {
    const Vec3 n = normalized({p[0], p[1], p[2]});
    add_point(soup, n.x, n.y, n.z);
  }
  soup.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                  3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
  return soup;
}

void append(TriangleSoup& soup, const TriangleSoup& other, const Vec3& shift) {
  const auto first = static_cast<Index>(soup.positions.size());
  for (const Vec3f& p : other.positions) add_point(soup, p.x + shift.x, p.y + shift.y, p.z + shift.z);
  for (const Index i : other.indices) soup.indices.push_back(first + i);
}

/// Adds one triangle for each step of a circle of n points that starts at `ring`, to the point `apex`.
void add_fan(TriangleSoup& soup, Index apex, Index ring, int n, bool upwards) {
  for (int i = 0; i < n; ++i) {
    const Index a = ring + static_cast<Index>(i);
    const Index b = ring + static_cast<Index>((i + 1) % n);
    upwards ? add_triangle(soup, apex, a, b) : add_triangle(soup, apex, b, a);
  }
}

Index add_circle(TriangleSoup& soup, int n) {
  const auto first = static_cast<Index>(soup.positions.size());
  for (int i = 0; i < n; ++i) add_point(soup, std::cos(kTurn * i / n), std::sin(kTurn * i / n), 0);
  return first;
}

}  // namespace

TriangleSoup empty_soup() { return {}; }

TriangleSoup single_triangle() {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.indices = {0, 1, 2};
  return soup;
}

TriangleSoup grid(int n, double noise, std::uint64_t seed) {
  Random random(seed);
  return sheet(n, n, [&](int i, int j) {
    return std::array{double(i) / n, double(j) / n, noise * random.signed_unit()};
  });
}

TriangleSoup terrain(int n, std::uint64_t seed) {
  Random random(seed);
  std::array<std::array<double, 2>, 4> phases{};
  for (auto& phase : phases) phase = {kTurn * random.unit(), kTurn * random.unit()};
  return sheet(n, n, [&](int i, int j) {
    const double x = double(i) / n, y = double(j) / n;
    double height = 0;
    double scale = 1;
    for (const auto& [phase_x, phase_y] : phases) {
      height += 0.1 / scale * std::sin(3 * scale * x + phase_x) * std::cos(4 * scale * y + phase_y);
      scale *= 2.3;
    }
    return std::array{x, y, height};
  });
}

TriangleSoup annulus(int m, int n) {
  TriangleSoup soup;
  for (int j = 0; j <= n; ++j) {
    const double radius = 1 - 0.5 * j / n;
    for (int i = 0; i < m; ++i) add_point(soup, radius * std::cos(kTurn * i / m), radius * std::sin(kTurn * i / m), 0);
  }
  add_squares(soup, m, n, [&](int i, int j) { return static_cast<Index>(j * m + i % m); });
  return soup;
}

TriangleSoup cylinder(int m, int n) {
  TriangleSoup soup;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i < m; ++i) add_point(soup, std::cos(kTurn * i / m), std::sin(kTurn * i / m), 2.0 * j / n);
  }
  add_squares(soup, m, n, [&](int i, int j) { return static_cast<Index>(j * m + i % m); });
  return soup;
}

TriangleSoup fan(int n, double height) {
  TriangleSoup soup;
  const Index apex = add_point(soup, 0, 0, height);
  add_fan(soup, apex, add_circle(soup, n), n, true);
  return soup;
}

TriangleSoup tetrahedron() {
  TriangleSoup soup;
  soup.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  soup.indices = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
  return soup;
}

TriangleSoup cube(int n) {
  TriangleSoup soup;
  for (int side = 0; side < 6; ++side) add_cube_side(soup, side, n);
  return soup;
}

TriangleSoup icosphere(int subdivisions, double noise, std::uint64_t seed) {
  TriangleSoup soup = icosahedron();
  for (int i = 0; i < subdivisions; ++i) subdivide_sphere(soup);
  Random random(seed);
  for (Vec3f& p : soup.positions) {
    const Vec3 moved = Vec3(p) * (1 + noise * random.signed_unit());
    p = to_float(moved);
  }
  return soup;
}

TriangleSoup torus(int m, int n) {
  TriangleSoup soup;
  for (int j = 0; j < n; ++j) {
    const double radius = 1 + 0.4 * std::cos(kTurn * j / n);
    const double z = 0.4 * std::sin(kTurn * j / n);
    for (int i = 0; i < m; ++i) add_point(soup, radius * std::cos(kTurn * i / m), radius * std::sin(kTurn * i / m), z);
  }
  add_squares(soup, m, n, [&](int i, int j) { return static_cast<Index>(j % n * m + i % m); });
  return soup;
}

TriangleSoup double_cone(int n) {
  TriangleSoup soup;
  const Index top = add_point(soup, 0, 0, 1);
  const Index bottom = add_point(soup, 0, 0, -1);
  const Index ring = add_circle(soup, n);
  add_fan(soup, top, ring, n, true);
  add_fan(soup, bottom, ring, n, false);
  return soup;
}

TriangleSoup many_components(int count) {
  TriangleSoup soup;
  for (int i = 0; i < count; ++i) {
    append(soup, icosphere(i % 2, 0.1, static_cast<std::uint64_t>(i)), {3.0 * (i % 8), 3.0 * (i / 8), 0});
  }
  return soup;
}

TriangleSoup seam_cube(int n) {
  TriangleSoup soup = cube(n);
  std::vector<float> normals;
  std::vector<float> uvs;
  for (int side = 0; side < 6; ++side) {
    std::array<float, 3> normal{};
    normal[static_cast<std::size_t>(side / 2)] = side % 2 == 0 ? 1.f : -1.f;
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        normals.insert(normals.end(), normal.begin(), normal.end());
        uvs.insert(uvs.end(), {float(i) / float(n), float(j) / float(n)});
      }
    }
  }
  soup.attributes = {float_attribute("NORMAL", 3, normals), float_attribute("TEXCOORD_0", 2, uvs)};
  return soup;
}

TriangleSoup seam_sphere(int m, int n) {
  TriangleSoup soup;
  std::vector<float> normals;
  std::vector<float> uvs;
  for (int j = 0; j <= n; ++j) {
    const bool pole = j == 0 || j == n;
    const double radius = std::sin(kTurn / 2 * j / n);
    const double z = -std::cos(kTurn / 2 * j / n);
    for (int i = 0; i <= m; ++i) {
      if ((j == 0 && i == m) || (j == n && i == 0)) continue;  // no triangle uses these
      // i % m: the first and the last column are one line of vertices. No −0 at the poles, for the same reason.
      const double angle = kTurn * (i % m) / m;
      add_point(soup, pole ? 0 : radius * std::cos(angle), pole ? 0 : radius * std::sin(angle), z);
      const Vec3f& p = soup.positions.back();
      normals.insert(normals.end(), {p.x, p.y, p.z});
      uvs.insert(uvs.end(), {float(i) / float(m), float(j) / float(n)});
    }
  }
  const auto point = [&](int i, int j) { return static_cast<Index>(j * (m + 1) + i - (j > 0) - (j == n)); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < m; ++i) {
      if (j > 0) add_triangle(soup, point(i, j), point(i + 1, j), point(i + 1, j + 1));
      if (j + 1 < n) add_triangle(soup, point(i, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
  soup.attributes = {float_attribute("NORMAL", 3, normals), float_attribute("TEXCOORD_0", 2, uvs)};
  return soup;
}

TriangleSoup two_material_grid(int n) {
  TriangleSoup soup = grid(n, 0.01, 11);
  for (std::size_t t = 0; t < soup.indices.size(); t += 3) {
    // The first point of either triangle of a square lies on the square's left edge.
    soup.face_material.push_back(soup.indices[t] % static_cast<Index>(n + 1) * 2 >= static_cast<Index>(n) ? 1 : 0);
  }
  return soup;
}

TriangleSoup two_material_sphere(int subdivisions) {
  TriangleSoup soup = icosphere(subdivisions, 0, 0);
  for (std::size_t t = 0; t < soup.indices.size(); t += 3) {
    double z = 0;
    for (std::size_t k = 0; k < 3; ++k) z += soup.positions[soup.indices[t + k]].z;
    soup.face_material.push_back(z < 0 ? 1 : 0);
  }
  return soup;
}

namespace {

/// Gives every triangle points of its own.
TriangleSoup exploded(const TriangleSoup& soup) {
  TriangleSoup result;
  for (const Index point : soup.indices) {
    result.indices.push_back(static_cast<Index>(result.positions.size()));
    result.positions.push_back(soup.positions[point]);
  }
  return result;
}

void append_vector(std::vector<float>& values, const Vec3& v) {
  values.insert(values.end(), {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
}

/// Normals of the triangles of an exploded soup, by point.
Attribute flat_normals(const TriangleSoup& soup) {
  std::vector<float> normals;
  for (std::size_t t = 0; t < soup.positions.size(); t += 3) {
    const Vec3 a(soup.positions[t]), b(soup.positions[t + 1]), c(soup.positions[t + 2]);
    for (int k = 0; k < 3; ++k) append_vector(normals, normalized(cross(b - a, c - a)));
  }
  return float_attribute("NORMAL", 3, normals);
}

}  // namespace

TriangleSoup faceted_sphere(int subdivisions) {
  TriangleSoup soup = exploded(icosphere(subdivisions, 0, 0));
  soup.attributes = {flat_normals(soup)};
  return soup;
}

TriangleSoup faceted_cylinder(int m, int n) {
  TriangleSoup soup;
  std::vector<float> normals;
  for (int i = 0; i < m; ++i) {
    const double middle = kTurn * (i + 0.5) / m;
    const auto first = static_cast<Index>(soup.positions.size());
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k < 2; ++k) {
        const double angle = kTurn * ((i + k) % m) / m;
        add_point(soup, std::cos(angle), std::sin(angle), 2.0 * j / n);
        append_vector(normals, {std::cos(middle), std::sin(middle), 0});
      }
    add_squares(soup, 1, n, [&](int k, int j) {
      return static_cast<Index>(first + 2 * static_cast<Index>(j) + static_cast<Index>(k));
    });
  }
  soup.attributes = {float_attribute("NORMAL", 3, normals)};
  return soup;
}

TriangleSoup mirrored_terrain(int n) {
  TriangleSoup soup = terrain(n, 31);
  std::vector<float> uvs;
  for (const Vec3f& p : soup.positions) uvs.insert(uvs.end(), {std::abs(p.x - 0.5F), p.y});
  soup.attributes = {float_attribute("TEXCOORD_0", 2, uvs)};
  return soup;
}

TriangleSoup slit_grid(int n) {
  TriangleSoup soup = grid(n, 0.02, 21);
  std::vector<float> uvs;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) uvs.insert(uvs.end(), {float(i) / float(n), float(j) / float(n)});
  // The points of the middle column below the middle have a second wedge, for the faces to their left.
  std::map<Index, Index> twin;
  for (int j = 0; j < n / 2; ++j) {
    const auto point = static_cast<Index>(j * (n + 1) + n / 2);
    twin[point] = static_cast<Index>(soup.positions.size());
    soup.positions.push_back(soup.positions[point]);
    uvs.insert(uvs.end(), {uvs[2 * point] - 0.005F * float(n / 2 - j), uvs[2 * point + 1]});
  }
  for (std::size_t t = 0; t < soup.indices.size(); t += 3) {
    float x = 0;
    for (std::size_t k = 0; k < 3; ++k) x += soup.positions[soup.indices[t + k]].x / 3;
    for (std::size_t k = 0; k < 3 && x < 0.5F; ++k)
      if (const auto found = twin.find(soup.indices[t + k]); found != twin.end()) soup.indices[t + k] = found->second;
  }
  soup.attributes = {float_attribute("TEXCOORD_0", 2, uvs)};
  return soup;
}

TriangleSoup skinned_cylinder(int m, int n) {
  TriangleSoup soup = cylinder(m, n);
  std::vector<float> weights;
  Attribute joints;
  joints.name = "JOINTS_0";
  joints.type = ComponentType::UInt8;
  joints.component_count = 4;
  for (const Vec3f& p : soup.positions) {
    const float along = std::clamp(2 * p.z - 0.5F, 0.0F, 1.0F);
    weights.insert(weights.end(), {1 - along, along, 0, 0});
    for (const int joint : {0, 1, 0, 0}) joints.data.push_back(static_cast<std::byte>(joint));
  }
  soup.attributes = {joints, float_attribute("WEIGHTS_0", 4, weights)};
  return soup;
}

TriangleSoup morph_grid(int n) {
  TriangleSoup soup = grid(n, 0, 0);
  std::vector<float> target;
  for (const Vec3f& p : soup.positions) {
    const float x = 4 * p.x - 2;
    const float y = 4 * p.y - 2;
    target.insert(target.end(), {0, 0, 0.5F * std::exp(-x * x - y * y)});
  }
  soup.attributes = {float_attribute("TARGET_0:POSITION", 3, target)};
  return soup;
}

TriangleSoup walled_cube(int n) {
  TriangleSoup soup = cube(n);
  append(soup, sheet(n, n, [&](int i, int j) { return std::array{0.5, double(i) / n, double(j) / n}; }), {0, 0, 0});
  return soup;
}

TriangleSoup cubes_at_an_edge(int n) {
  TriangleSoup soup = cube(n);
  append(soup, cube(n), {1, 1, 0});
  return soup;
}

TriangleSoup spheres_at_a_vertex(int subdivisions) {
  TriangleSoup soup = icosphere(subdivisions, 0, 0);
  TriangleSoup mirrored = soup;
  const Vec3f at = soup.positions[0];
  for (Vec3f& p : mirrored.positions) p = {2 * at.x - p.x, 2 * at.y - p.y, 2 * at.z - p.z};
  for (std::size_t t = 0; t < mirrored.indices.size(); t += 3) std::swap(mirrored.indices[t], mirrored.indices[t + 1]);
  append(soup, mirrored, {0, 0, 0});
  return soup;
}

TriangleSoup mobius_strip(int m, int n) {
  TriangleSoup soup;
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double across = (2.0 * j / n - 1) * 0.3;
      const double radius = 1 + across * std::cos(kTurn / 2 * i / m);
      add_point(soup, radius * std::cos(kTurn * i / m), radius * std::sin(kTurn * i / m),
                across * std::sin(kTurn / 2 * i / m));
    }
  }
  // Past the end the band meets its start upside down.
  add_squares(soup, m, n, [&](int i, int j) { return static_cast<Index>(i < m ? i * (n + 1) + j : n - j); });
  return soup;
}

TriangleSoup bow_tie() {
  TriangleSoup soup = fan(6, 0.5);
  const TriangleSoup other = fan(5, -0.5);
  append(soup, other, {0, 0, 1});  // both apexes at (0, 0, 0.5)
  return soup;
}

TriangleSoup three_at_one_edge() {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  soup.indices = {0, 1, 2, 1, 0, 3, 0, 1, 4};
  return soup;
}

TriangleSoup disagreeing_pair() {
  TriangleSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.indices = {0, 1, 2, 0, 3, 2};
  return soup;
}

TriangleSoup random_squares(int n, std::uint64_t seed) {
  TriangleSoup soup;
  Random random(seed);
  for (int i = 0; i < n * n * n; ++i) add_point(soup, i % n, i / n % n, i / (n * n));
  const int step[] = {1, n, n * n};
  const std::uint64_t sparse = 2 + seed % 3;
  for (int i = 0; i < n * n * n; ++i) {
    const int place[] = {i % n, i / n % n, i / (n * n)};
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      if (place[u] + 1 == n || place[v] + 1 == n || random.below(sparse) > 0) continue;
      std::array<Index, 4> square{};
      for (int k = 0; k < 4; ++k)
        square[k] = static_cast<Index>(i + (k == 1 || k == 2 ? step[u] : 0) + (k > 1 ? step[v] : 0));
      for (std::uint64_t times = 1 + random.below(4) / 3; times > 0; --times) {
        std::rotate(square.begin(), square.begin() + static_cast<std::ptrdiff_t>(random.below(2)), square.end());
        if (random.below(2) == 0) std::reverse(square.begin(), square.end());
        add_square(soup, square[0], square[1], square[2], square[3]);
      }
    }
  }
  return soup;
}

TriangleSoup dirty_grid(int n) {
  TriangleSoup soup = grid(n, 0, 0);
  const Index infinite = add_point(soup, std::numeric_limits<double>::infinity(), 0, 0);
  const Index nan = add_point(soup, 0, std::numeric_limits<double>::quiet_NaN(), 0);
  const Index copy_of_first = add_point(soup, 0, 0, 0);
  add_point(soup, 7, 7, 7);  // unused
  add_triangle(soup, 0, 1, infinite);
  add_triangle(soup, nan, 1, 0);
  add_triangle(soup, 0, 1, 1);
  add_triangle(soup, 0, copy_of_first, 1);
  add_triangle(soup, soup.indices[1], soup.indices[2], soup.indices[0]);
  return soup;
}

TriangleSoup stacked(const TriangleSoup& shape, int count) {
  TriangleSoup soup = layered(shape, count);
  soup.face_material.clear();
  Attribute sheet{"_SHEET", ComponentType::UInt8, 1, false, {}};
  for (int i = 0; i < count; ++i) sheet.data.insert(sheet.data.end(), shape.positions.size(), std::byte(i));
  soup.attributes.push_back(std::move(sheet));
  return soup;
}

TriangleSoup layered(const TriangleSoup& shape, int count) {
  TriangleSoup soup;
  soup.attributes = shape.attributes;
  for (Attribute& attribute : soup.attributes) attribute.data.clear();
  for (int i = 0; i < count; ++i) {
    append(soup, shape, {});
    for (std::size_t a = 0; a < shape.attributes.size(); ++a) {
      const std::vector<std::byte>& data = shape.attributes[a].data;
      soup.attributes[a].data.insert(soup.attributes[a].data.end(), data.begin(), data.end());
    }
    soup.face_material.insert(soup.face_material.end(), shape.indices.size() / 3, static_cast<Index>(i));
  }
  return soup;
}

TriangleSoup two_sided(const TriangleSoup& shape) {
  TriangleSoup soup = shape;
  for (std::size_t t = 0; t < shape.indices.size(); t += 3)
    add_triangle(soup, shape.indices[t], shape.indices[t + 2], shape.indices[t + 1]);
  return soup;
}

TriangleSoup two_sided_squares(int n) {
  TriangleSoup soup = terrain(n, 7);
  const auto point = [&](int i, int j) { return static_cast<Index>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) add_square(soup, point(i, j + 1), point(i + 1, j + 1), point(i + 1, j), point(i, j));
  return soup;
}

TriangleSoup shuffled(const TriangleSoup& shape, std::uint64_t seed) {
  TriangleSoup soup = shape;
  Random random(seed);
  for (std::size_t left = shape.indices.size() / 3; left > 1; --left) {
    const std::size_t other = random.below(left);
    for (std::size_t k = 0; k < 3; ++k) std::swap(soup.indices[3 * (left - 1) + k], soup.indices[3 * other + k]);
    if (!soup.face_material.empty()) std::swap(soup.face_material[left - 1], soup.face_material[other]);
  }
  return soup;
}

TriangleSoup misturned(const TriangleSoup& shape, double share, std::uint64_t seed) {
  TriangleSoup soup = shape;
  Random random(seed);
  for (std::size_t t = 0; t < soup.indices.size(); t += 3)
    if (random.unit() < share) std::swap(soup.indices[t + 1], soup.indices[t + 2]);
  return soup;
}

TriangleSoup with_decal(const TriangleSoup& shape, double radius) {
  TriangleSoup soup = shape;
  soup.face_material.assign(shape.indices.size() / 3, 0);
  const auto is_near = [&](Index point) {
    return length(Vec3(shape.positions[point]) - Vec3(shape.positions[0])) <= radius;
  };
  for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
    const Index a = shape.indices[t], b = shape.indices[t + 1], c = shape.indices[t + 2];
    if (!is_near(a) || !is_near(b) || !is_near(c)) continue;
    add_triangle(soup, a, b, c);
    soup.face_material.push_back(1);
  }
  return soup;
}

std::vector<NamedShape> all_shapes() {
  return {
      {"empty", empty_soup(), true, 0},
      {"single triangle", single_triangle(), true, 1},
      {"tetrahedron", tetrahedron(), true, 2},
      {"cube 1", cube(1), true, 2},
      {"cube 4", cube(4), true, 2},
      {"flat grid 6", grid(6, 0, 1), true, 1},
      {"noisy grid 10", grid(10, 0.05, 2), true, 1},
      {"terrain 16", terrain(16, 3), true, 1},
      {"icosahedron", icosphere(0, 0, 0), true, 2},
      {"icosphere 2", icosphere(2, 0, 0), true, 2},
      {"noisy icosphere 3", icosphere(3, 0.05, 4), true, 2},
      {"torus 16 x 8", torus(16, 8), true, 0},
      {"thin torus 3 x 3", torus(3, 3), true, 0},
      {"annulus 12 x 3", annulus(12, 3), true, 0},
      {"cylinder 10 x 4", cylinder(10, 4), true, 0},
      {"narrow cylinder 3 x 6", cylinder(3, 6), true, 0},
      {"flat fan 40", fan(40, 0), true, 1},
      {"cone 100", fan(100, 1), true, 1},
      {"double cone 64", double_cone(64), true, 2},
      {"12 components", many_components(12), true, 24},
      {"seam cube 3", seam_cube(3), true, 2},
      {"seam sphere 12 x 8", seam_sphere(12, 8), true, 2},
      {"two-material grid 8", two_material_grid(8), true, 1},
      {"two-material sphere 2", two_material_sphere(2), true, 2},
      {"faceted sphere 2", faceted_sphere(2), true, 2},
      {"faceted cylinder 12 x 3", faceted_cylinder(12, 3), true, 0},
      {"mirrored terrain 12", mirrored_terrain(12), true, 1},
      {"slit grid 8", slit_grid(8), true, 1},
      {"skinned cylinder 10 x 6", skinned_cylinder(10, 6), true, 0},
      {"morph grid 8", morph_grid(8), true, 1},
      {"walled cube 4", walled_cube(4), false, std::nullopt},
      {"cubes at an edge 3", cubes_at_an_edge(3), false, std::nullopt},
      {"spheres at a vertex 1", spheres_at_a_vertex(1), false, std::nullopt},
      {"moebius strip 14 x 2", mobius_strip(14, 2), false, std::nullopt},
      {"bow-tie", bow_tie(), false, std::nullopt},
      {"three at one edge", three_at_one_edge(), false, std::nullopt},
      {"disagreeing pair", disagreeing_pair(), false, std::nullopt},
      {"dirty grid 4", dirty_grid(4), false, std::nullopt},
      {"two-sided terrain 8", two_sided(terrain(8, 3)), false, std::nullopt},
      {"two-sided icosphere 2", two_sided(icosphere(2, 0.05, 4)), false, std::nullopt},
      {"two-sided squares 8", two_sided_squares(8), false, std::nullopt},
      {"three layers of terrain 8", layered(terrain(8, 3), 3), false, std::nullopt},
      {"two layers of seam cube 3", stacked(seam_cube(3), 2), false, std::nullopt},
      {"two layers of skinned cylinder 8 x 4", stacked(skinned_cylinder(8, 4), 2), false, std::nullopt},
      {"decal on icosphere 2", with_decal(icosphere(2, 0.05, 4), 1), false, std::nullopt},
      {"decal at the border of terrain 10", with_decal(terrain(10, 3), 0.5), false, std::nullopt},
  };
}

std::vector<NamedShape> manifold_shapes() {
  std::vector<NamedShape> shapes = all_shapes();
  std::erase_if(shapes, [](const NamedShape& shape) { return !shape.manifold; });
  return shapes;
}

}  // namespace lodestone::test

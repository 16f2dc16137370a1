#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Returns the point of the segment a b nearest to `p`; any of the two where they coincide.
inline Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double ee = squared_length(e);
  if (!(ee > 0)) return a;
  const double t = dot(p - a, e);
  if (t <= 0) return a;
  if (t >= ee) return b;
  return a + e * (t / ee);
}

/// A triangle with the float corners of the mesh; computed with in doubles.
struct Triangle {
  Vec3f a, b, c;
};

inline Triangle triangle_of(const Mesh& mesh, Index face) {
  return {mesh.positions[mesh.corner_vertex(3 * face)], mesh.positions[mesh.corner_vertex(3 * face + 1)],
          mesh.positions[mesh.corner_vertex(3 * face + 2)]};
}

/// Whether no point of a triangle reaches over the plane through `nearest` that faces `p`: then none is nearer to p.
inline bool is_no_nearer(const Triangle& triangle, const Vec3& nearest, const Vec3& p) {
  const Vec3 towards = p - nearest;
  const double at_plane = dot(nearest, towards);
  return dot(Vec3(triangle.a), towards) <= at_plane && dot(Vec3(triangle.b), towards) <= at_plane &&
         dot(Vec3(triangle.c), towards) <= at_plane;
}

/// A triangle's nearest point, and the corners between which it lies: bit k stands for corner k.
struct NearestPoint {
  Vec3 point;
  unsigned corners = 0b111;
};

/// Returns the nearest point to `p` of a triangle, which may be as thin as a segment or a point.
///
/// Where p lies above the inside of all three edges the foot of the perpendicular is the answer; elsewhere the answer
/// is on an edge that p lies outside of. Each test uses the normal, the one quantity that keeps its accuracy in thin
/// triangles: tests by barycentric coordinates cancel there and name points far from the nearest.
inline NearestPoint nearest_in_triangle(const Vec3& p, const Triangle& triangle) {
  const Vec3 a(triangle.a), b(triangle.b), c(triangle.c);
  const Vec3 n = cross(b - a, c - a);
  const Vec3 pa = p - a, pb = p - b, pc = p - c;
  const bool outside_ab = dot(cross(b - a, pa), n) <= 0;
  const bool outside_bc = dot(cross(c - b, pb), n) <= 0;
  const bool outside_ca = dot(cross(a - c, pc), n) <= 0;
  if (!outside_ab && !outside_bc && !outside_ca) return {p - n * (dot(pa, n) / squared_length(n)), 0b111};

  NearestPoint best{a, 0b001};
  double best_squared = squared_length(pa);
  const auto consider = [&](bool outside, const Vec3& from, const Vec3& to, unsigned at_from, unsigned at_to) {
    if (!outside) return;
    const Vec3 q = nearest_on_segment(p, from, to);
    const double squared = squared_length(p - q);
    if (squared >= best_squared) return;
    best = {q, q == from ? at_from : q == to ? at_to : at_from | at_to};
    best_squared = squared;
  };
  consider(outside_ab, a, b, 0b001, 0b010);
  consider(outside_bc, b, c, 0b010, 0b100);
  consider(outside_ca, c, a, 0b100, 0b001);
  return best;
}

inline Vec3 nearest_on_triangle(const Vec3& p, const Triangle& triangle) {
  return nearest_in_triangle(p, triangle).point;
}

/// The k-th of a sequence of points that spreads evenly over a triangle: see point_on_face.
inline Vec3 point_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t k) {
  const double n = static_cast<double>(k);
  const auto fraction = [](double x) { return x - static_cast<double>(static_cast<std::int64_t>(x)); };
  double u = fraction(0.5 + n * 0.7548776662466927);
  double v = fraction(0.5 + n * 0.5698402909980532);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return a * (1 - u - v) + b * u + c * v;
}

/// A point of a triangle, by the weights of its corners.
struct Barycentric {
  std::array<double, 3> weights{1, 0, 0};
  double squared_distance = 0;  ///< from the point that was asked for
};

/// Returns the weights of a triangle's corners at a point of it; `squared_distance` is passed on.
inline Barycentric weights_at(const Vec3& q, const Triangle& triangle, double squared_distance) {
  const Vec3 a(triangle.a), b(triangle.b), c(triangle.c);
  const Vec3 n = cross(b - a, c - a);
  const double nn = squared_length(n);
  Barycentric result{{1, 0, 0}, squared_distance};
  if (!(nn > 0)) return result;
  const double at_b = std::clamp(dot(cross(q - a, c - a), n) / nn, 0.0, 1.0);
  const double at_c = std::clamp(dot(cross(b - a, q - a), n) / nn, 0.0, 1.0 - at_b);
  result.weights = {1 - at_b - at_c, at_b, at_c};
  return result;
}

/// Returns the point of a triangle nearest to `p`.
inline Barycentric nearest_weights(const Vec3& p, const Triangle& triangle) {
  const Vec3 q = nearest_on_triangle(p, triangle);
  return weights_at(q, triangle, squared_length(p - q));
}

}  // namespace lodestone::detail

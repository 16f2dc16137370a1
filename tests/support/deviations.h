#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/surface_index.h>

#include "support/catch.h"
#include "support/random.h"

// Meshes to measure, and what is known of their deviation without the code that measures it.

namespace lodestone::test {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A mesh as it is, with nothing joined or dropped.
inline Mesh raw_mesh(std::vector<Vec3f> positions, std::vector<Index> corners) {
  Mesh mesh;
  for (Index v = 0; v < positions.size(); ++v) mesh.wedge_vertex.push_back(v);
  mesh.positions = std::move(positions);
  mesh.corner_wedge = std::move(corners);
  return mesh;
}

inline Mesh shifted(Mesh mesh, float x, float y, float z) {
  for (Vec3f& p : mesh.positions) p = {p.x + x, p.y + y, p.z + z};
  return mesh;
}

/// The vertices of each cell of a grid become the first of them: a level with some of the mesh's vertices, never clean.
inline Mesh clustered(const Mesh& mesh, double cell) {
  std::map<std::tuple<long, long, long>, Index> first;
  std::vector<Index> kept(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3f& p = mesh.positions[v];
    kept[v] = first.emplace(std::tuple{std::lround(p.x / cell), std::lround(p.y / cell), std::lround(p.z / cell)}, v)
                  .first->second;
  }
  std::vector<Index> corners;
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3) {
    const Index x = kept[mesh.corner_vertex(c)], y = kept[mesh.corner_vertex(c + 1)],
                z = kept[mesh.corner_vertex(c + 2)];
    if (x != y && y != z && z != x) corners.insert(corners.end(), {x, y, z});
  }
  return raw_mesh(mesh.positions, std::move(corners));
}

/// The mesh without a share of its faces, chosen by the seed.
inline Mesh with_holes(const Mesh& mesh, double share, std::uint64_t seed) {
  Random random(seed);
  std::vector<Index> corners;
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3) {
    if (random.unit() < share) continue;
    for (Index i = 0; i < 3; ++i) corners.push_back(mesh.corner_vertex(c + i));
  }
  return raw_mesh(mesh.positions, std::move(corners));
}

/// How far meshes lie apart, the larger of both ways. Few samples do: they are for the means, and take most of the
/// time.
template <class Surface>
double largest_deviation(const Surface& a, const Surface& b) {
  DeviationOptions options;
  options.sample_count = 1000;
  return measure_deviation(a, b, options).maximum();
}

inline double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double ee = squared_length(b - a);
  const double t = ee > 0 ? std::clamp(dot(p - a, b - a) / ee, 0.0, 1.0) : 0;
  return length(p - (a + (b - a) * t));
}

/// The distance to a triangle from its definition: to its edges, or to its plane where the foot is inside.
inline double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  double distance = std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
  const Vec3 n = normalized(cross(b - a, c - a));
  const Vec3 foot = p - n * dot(p - a, n);
  const bool inside =
      dot(cross(b - a, foot - a), n) > 0 && dot(cross(c - b, foot - b), n) > 0 && dot(cross(a - c, foot - c), n) > 0;
  return inside ? std::min(distance, length(p - foot)) : distance;
}

inline double distance_to_all(const Vec3& p, const Mesh& mesh) {
  double distance = kInfinity;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    distance = std::min(distance, triangle_distance(p, mesh.corner_position(3 * f), mesh.corner_position(3 * f + 1),
                                                    mesh.corner_position(3 * f + 2)));
  }
  return distance;
}

/// A range that certainly holds the supremum: dense samples, and how far any point may be from one.
struct SampledSupremum {
  double low = 0;
  double high = 0;
};

/// `distance_from(p)`: how far the other surface is from a point.
template <class Distance>
SampledSupremum sample_supremum(const Mesh& from, const Distance& distance_from, int steps) {
  SampledSupremum result;
  for (Index f = 0; f < from.face_count(); ++f) {
    const Vec3 a = from.corner_position(3 * f), b = from.corner_position(3 * f + 1),
               c = from.corner_position(3 * f + 2);
    double largest = 0;
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const Vec3 p = a + (b - a) * (1.0 * i / steps) + (c - a) * (1.0 * j / steps);
        largest = std::max(largest, distance_from(p));
      }
    }
    const double spacing = std::max({length(b - a), length(c - b), length(a - c)}) / steps;
    result.low = std::max(result.low, largest);
    result.high = std::max(result.high, largest + spacing);
  }
  return result;
}

inline SampledSupremum sample_supremum(const Mesh& from, const Mesh& to, int steps) {
  const SurfaceIndex index(to);
  return sample_supremum(
      from, [&](const Vec3& p) { return index.nearest(p, kInfinity).distance; }, steps);
}

inline void check_contains(const OneSidedDeviation& found, const SampledSupremum& sampled) {
  CHECK(found.maximum <= found.maximum_bound);
  CHECK(found.maximum <= sampled.high * (1 + 1e-9) + 1e-12);
  CHECK(found.maximum_bound >= sampled.low * (1 - 1e-9) - 1e-12);
}

inline double allowed(double maximum, const DeviationOptions& options, double diagonal) {
  const double absolute = options.absolute_tolerance > 0 ? options.absolute_tolerance : 1e-7 * diagonal;
  return (maximum * (1 + options.relative_tolerance) + absolute) * (1 + 1e-9);
}

inline bool overlap(const Deviation& a, const Deviation& b) {
  return a.maximum() <= b.maximum_bound() + 1e-12 && b.maximum() <= a.maximum_bound() + 1e-12;
}

}  // namespace lodestone::test

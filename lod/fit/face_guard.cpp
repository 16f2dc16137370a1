#include "fit/face_guard.h"

#include <algorithm>

#include "distance/triangle.h"

namespace lodestone::detail {
namespace {

constexpr double kMinCosine = 0.5;     // of the angle a face may turn by in one go
constexpr double kMinShape = 0.02;     // a face's height over its longest edge
constexpr double kSliverKeeps = 0.98;  // of its shape, in one go, where that is less

constexpr double kFacesWell = 0.5;     // a face that looked within 60° of the original's way …
constexpr double kTurnsLittle = 0.87;  // … and has turned by less than 30° since does not look away from there

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
      // What was a sliver may stay one, as long as it gets hardly worse.
      const double new_shape = shape(p, q, r);
      if (keeps_direction(p, q, r, cross(b - a, c - a)) &&
          (new_shape > kMinShape || new_shape >= kSliverKeeps * shape(a, b, c)))
        continue;
      for (const Index i : v) positions[i] = mesh.positions[i];
      changed = true;
    }
  }
}

OriginalGuard::Survey OriginalGuard::survey(const Mesh& level, const SampleNorm& norm) {
  standing_.resize(level.face_count());
  Survey result;
  for (Index f = 0; f < level.face_count(); ++f) {
    const double share = 0.5 * length(area_vector(level, f)) / kPointsOfFace;
    Distances inside{};
    standing_[f] = look_at(corners_of(level, f, level.positions), standing_[f].near, &inside);
    result.farthest = std::max(result.farthest, standing_[f].distance);
    for (const double distance : inside) result.error += share * norm.error(distance * distance);
  }
  return result;
}

bool OriginalGuard::keep_faces_near(const Mesh& level, std::vector<Vec3f>& positions) {
  bool all_near = true;
  for (Index f = 0; f < level.face_count(); ++f) {
    const Corners before = corners_of(level, f, level.positions);
    const Corners now = corners_of(level, f, positions);
    Standing& standing = standing_[f];
    if (now == before || is_surely_fine(standing, now)) continue;
    standing = look_at(now, standing.near);
    const bool looks_away = standing.facing < 0 && look_at(before, standing.near).facing >= 0;
    if (standing.distance <= reach_ && !looks_away) continue;
    all_near = false;
    for (Index k = 0; k < 3; ++k) {
      const Index v = level.corner_vertex(3 * f + k);
      positions[v] = level.positions[v];
    }
  }
  return all_near;
}

bool OriginalGuard::lets_pass(const std::array<Corners, 2>& now, const std::array<Corners, 2>& before) const {
  bool looks_away = false;
  for (const Corners& corners : now) {
    const Standing standing = look_at(corners, kNoIndex);
    if (standing.distance > reach_) return false;
    looks_away = looks_away || standing.facing < 0;
  }
  const auto looked_away = [&](const Corners& corners) { return look_at(corners, kNoIndex).facing < 0; };
  return !looks_away || std::any_of(before.begin(), before.end(), looked_away);
}

OriginalGuard::Corners OriginalGuard::corners_of(const Mesh& level, Index face, const std::vector<Vec3f>& positions) {
  return {Vec3(positions[level.corner_vertex(3 * face)]), Vec3(positions[level.corner_vertex(3 * face + 1)]),
          Vec3(positions[level.corner_vertex(3 * face + 2)])};
}

/// Walks to the original's nearest point, and searches for it where none was known near there, or the one found is out
/// of reach: that may lie on the way to a nearer one.
OriginalGuard::Nearest OriginalGuard::nearest(const Vec3& point, Index near) const {
  if (near != kNoIndex) {
    const SurfaceWalk::Place place = walk_.nearest_from(point, near);
    const double distance = std::sqrt(place.on.squared_distance);
    if (distance <= reach_) return {place.face, distance};
    near = place.face;
  }
  const SurfaceIndex::Hit hit = index_.nearest(point, std::numeric_limits<double>::infinity(), near);
  return {hit.face, hit.distance};
}

/// `near` is a face of the original near there, if known.
OriginalGuard::Standing OriginalGuard::look_at(const Corners& corners, Index near, Distances* inside) const {
  const auto& [a, b, c] = corners;
  Standing result{{to_float(a), to_float(b), to_float(c)}, 0, -1, near};
  if (!steps_.next()) return result;
  const auto visit = [&](const Vec3& point) {
    const Nearest found = nearest(point, result.near);
    result.distance = std::max(result.distance, found.distance);
    result.near = found.face;
    return found.distance;
  };
  for (const Vec3& corner : corners) visit(corner);
  const Vec3 normal = normalized(cross(b - a, c - a));
  for (std::size_t k = 0; k < kPointsOfFace; ++k) {
    const double distance = visit(point_on_triangle(a, b, c, k));
    if (inside != nullptr) (*inside)[k] = distance;
    result.facing = std::max(result.facing, dot(normal, normalized(area_vector(original_, result.near))));
  }
  return result;
}

/// Whether a face that is now at `corners` need not be looked at: no point of it has moved farther than a corner has.
bool OriginalGuard::is_surely_fine(const Standing& last, const Corners& corners) const {
  double way = 0;
  for (std::size_t k = 0; k < 3; ++k) way = std::max(way, length(corners[k] - Vec3(last.corners[k])));
  if (last.distance + way > reach_ || last.facing < kFacesWell) return false;
  const Corners before{Vec3(last.corners[0]), Vec3(last.corners[1]), Vec3(last.corners[2])};
  const auto normal = [](const Corners& c) { return normalized(cross(c[1] - c[0], c[2] - c[0])); };
  return dot(normal(corners), normal(before)) > kTurnsLittle;
}

}  // namespace lodestone::detail

#include "fit/face_guard.h"

#include <algorithm>
#include <utility>

#include "distance/triangle.h"

namespace lodestone::detail {
namespace {

constexpr double kMinCosine = 0.5;     // of the angle a face may turn by in one go
constexpr double kMinShape = 0.02;     // a face's height over its longest edge
constexpr double kSliverKeeps = 0.98;  // of its shape, in one go, where that is less

constexpr double kFacesWell = 0.5;     // a face that looked within 60° of the original's way …
constexpr double kTurnsLittle = 0.87;  // … and has turned by less than 30° since does not look away from there

Vec3 area_vector(const Corners& c) { return cross(c[1] - c[0], c[2] - c[0]); }

double shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)});
  return longest > 0 ? length(cross(b - a, c - a)) / longest : 0;
}

bool keeps_direction(const Vec3& normal, const Vec3& before) {
  const double product = dot(normal, before);
  return product > 0 && product * product > kMinCosine * kMinCosine * squared_length(normal) * squared_length(before);
}

/// What was a sliver may stay one, as long as it gets hardly worse.
bool stays_upright(const Corners& before, const Corners& now) {
  const auto& [a, b, c] = now;
  if (!keeps_direction(area_vector(now), area_vector(before))) return false;
  const double now_shape = shape(a, b, c);
  return now_shape > kMinShape || now_shape >= kSliverKeeps * shape(before[0], before[1], before[2]);
}

}  // namespace

bool is_upright(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& before) {
  return keeps_direction(cross(b - a, c - a), before) && shape(a, b, c) > kMinShape;
}

TentativeMoves::TentativeMoves(const Mesh& level, std::vector<Vec3f> positions)
    : level_(level), positions_(std::move(positions)), changed_at_(level.vertex_count(), 0) {
  for (Index v = 0; v < positions_.size(); ++v)
    if (is_moved(v)) changed_at_[v] = kStart;
}

bool TentativeMoves::has_news(Index face, Index time) const {
  bool moved = false, changed = false;
  for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
    const Index v = level_.corner_vertex(corner);
    moved = moved || is_moved(v);
    changed = changed || changed_at_[v] >= time;
  }
  return moved && changed;
}

void TentativeMoves::put_back(Index face) {
  for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
    const Index v = level_.corner_vertex(corner);
    if (!is_moved(v)) continue;
    positions_[v] = level_.positions[v];
    changed_at_[v] = time_;
  }
}

void keep_faces_upright(TentativeMoves& moves, Index& looked_at) {
  for (bool changed = true; changed;) {
    changed = false;
    const Index since = std::exchange(looked_at, moves.next_time());
    for (Index f = 0; f < moves.level().face_count(); ++f) {
      if (!moves.has_news(f, since) || stays_upright(moves.before(f), moves.now(f))) continue;
      moves.put_back(f);
      changed = true;
    }
  }
}

void OriginalGuard::start_from(const std::vector<Index>& faces) {
  standing_.resize(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) standing_[f].near = faces[f];
}

OriginalGuard::Survey OriginalGuard::survey(const Mesh& level, const SampleNorm& norm) {
  standing_.resize(level.face_count());
  Survey result;
  for (Index f = 0; f < level.face_count(); ++f) {
    Standing& standing = standing_[f];
    standing = Standing(corners_at(level, level.positions, f), standing.near);
    const double share = 0.5 * length(area_vector(level, f)) / kPointsOfFace;
    for (const double distance : look_inside(standing)) result.error += share * norm.error(distance * distance);
    result.farthest = std::max(result.farthest, standing.distance);
  }
  return result;
}

bool OriginalGuard::keep_faces_near(TentativeMoves& moves, Index& looked_at) {
  bool all_near = true;
  const Index since = std::exchange(looked_at, moves.next_time());
  for (Index f = 0; f < moves.level().face_count(); ++f) {
    if (!moves.has_news(f, since)) continue;
    const Corners before = moves.before(f), now = moves.now(f);
    Standing& standing = standing_[f];
    if (is_surely_fine(standing, now)) continue;
    standing = look_at(now, standing.near);
    const bool looks_away = standing.facing < 0 && look_at(before, standing.near).facing >= 0;
    if (standing.distance <= reach_ && !looks_away) continue;
    all_near = false;
    moves.put_back(f);
  }
  return all_near;
}

bool OriginalGuard::lets_pass(const std::array<Corners, 2>& now, const std::array<Corners, 2>& before,
                              const std::array<Index, 2>& faces) const {
  const Index near = standing_[faces[0]].near;
  bool looks_away = false;
  for (const Corners& corners : now) {
    const Standing standing = look_at(corners, near);
    if (standing.distance > reach_) return false;
    looks_away = looks_away || standing.facing < 0;
  }
  const auto looked_away = [&](const Corners& corners) { return look_at(corners, near).facing < 0; };
  return !looks_away || std::any_of(before.begin(), before.end(), looked_away);
}

/// Walks to the original's nearest point, and searches for it where none was known near there, or the one found is out
/// of reach: that may lie on the way to a nearer one.
NearFace OriginalGuard::nearest(const Vec3& point, Index near) const {
  if (near != kNoIndex) {
    const SurfaceWalk::Place place = walk_.nearest_from(point, near);
    const double distance = std::sqrt(place.on.squared_distance);
    if (distance <= reach_) return {place.face, distance};
    near = place.face;
  }
  return boxes_.nearest(point, near);
}

OriginalGuard::Standing::Standing(const Corners& c, Index face_near)
    : corners{to_float(c[0]), to_float(c[1]), to_float(c[2])}, near(face_near) {}

/// `near` is a face of the original near there, if known.
OriginalGuard::Standing OriginalGuard::look_at(const Corners& corners, Index near) const {
  Standing standing(corners, near);
  for (const Vec3& corner : corners) visit(corner, standing);
  look_inside(standing);
  return standing;
}

double OriginalGuard::visit(const Vec3& point, Standing& standing) const {
  const NearFace found = nearest(point, standing.near);
  standing.distance = std::max(standing.distance, found.distance);
  standing.near = found.face;
  return found.distance;
}

/// Looks at points that are not corners; returns their distances.
OriginalGuard::Distances OriginalGuard::look_inside(Standing& standing) const {
  Distances distances{};
  if (!steps_.next()) return distances;
  const Vec3 a(standing.corners[0]), b(standing.corners[1]), c(standing.corners[2]);
  const Vec3 normal = normalized(cross(b - a, c - a));
  for (std::size_t k = 0; k < kPointsOfFace; ++k) {
    distances[k] = visit(point_on_triangle(a, b, c, k), standing);
    standing.facing = std::max(standing.facing, dot(normal, walk_.normal(standing.near)));
  }
  return distances;
}

/// Whether a face that is now at `corners` need not be looked at: no point of it has moved farther than a corner has.
bool OriginalGuard::is_surely_fine(const Standing& last, const Corners& corners) const {
  double way = 0;
  for (std::size_t k = 0; k < 3; ++k) way = std::max(way, length(corners[k] - Vec3(last.corners[k])));
  if (last.distance + way > reach_ || last.facing < kFacesWell) return false;
  const Corners before{Vec3(last.corners[0]), Vec3(last.corners[1]), Vec3(last.corners[2])};
  const Vec3 normal = area_vector(corners), was = area_vector(before);
  const double product = dot(normal, was);
  return product > 0 && product * product > kTurnsLittle * kTurnsLittle * squared_length(normal) * squared_length(was);
}

}  // namespace lodestone::detail

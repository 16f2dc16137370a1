// The bound comes from a map between the two surfaces, after Cohen, Manocha, Olano: Simplifying polygonal models using
// successive mappings (Visualization 1997). Both are projected to a plane; where neither folds there, the overlay of
// their edges cuts them into cells on which both are linear, so the largest displacement stands at a corner of a cell:
// at the removed vertex or where a spoke crosses a diagonal. On an open sector the removed vertex first slides to its
// foot on the closing edge, on a moved one to the vertex it moves to. A star of several sectors may also be looked at
// as one. Where every projection folds, and where the map moves points by as much as a spoke, the distances between the
// faces are searched.

#include "distance/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "distance/patch_distance.h"
#include "distance/point_triangle.h"
#include "distance/triangle.h"

namespace lodestone::detail {
namespace {

struct Vec2 {
  double x = 0;
  double y = 0;
};

double cross2(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A sector's polygon, coarse faces and centre, in space and in the plane of projection; or those of a whole star.
struct Overlay {
  SectorShape shape;
  Vec3 center;
  Vec3 image;  // where the centre goes: itself, or its foot on the closing edge
  std::vector<PolygonTriangle> triangles;
  std::vector<Vec3> ring;
  std::vector<Vec2> plane_ring;
  Vec2 plane_center;

  std::size_t face_count() const { return shape == SectorShape::Closed ? ring.size() : ring.size() - 1; }
  std::size_t next(std::size_t i) const { return i + 1 < ring.size() ? i + 1 : 0; }
  bool is_rim(std::size_t a, std::size_t b) const { return b == a + 1 || (a == 0 && b + 1 == ring.size()); }
};

Vec3 fine_normal(const Overlay& overlay) {
  Vec3 normal;
  for (std::size_t i = 0; i < overlay.face_count(); ++i)
    normal += cross(overlay.ring[i] - overlay.image, overlay.ring[overlay.next(i)] - overlay.image);
  return normal;
}

Vec3 coarse_normal(const Overlay& overlay) {
  Vec3 normal;
  for (const PolygonTriangle t : overlay.triangles)
    normal += normalized(cross(overlay.ring[t.b] - overlay.ring[t.a], overlay.ring[t.c] - overlay.ring[t.a]));
  return normal;
}

Overlay make_overlay(const Mesh& mesh, const SectorPatch& sector, const Vec3& center) {
  Overlay overlay{sector.shape, center, center, sector.triangles, {}, {}, {}};
  for (const Index wedge : sector.polygon) overlay.ring.push_back(Vec3(mesh.positions[mesh.wedge_vertex[wedge]]));
  if (sector.shape == SectorShape::Open)
    overlay.image = nearest_on_segment(center, overlay.ring.back(), overlay.ring.front());
  return overlay;
}

/// All sectors of a star as one.
Overlay make_overlay(const Mesh& mesh, const RemovalRecord& record, const Vec3& center) {
  Overlay overlay{record.open_star ? SectorShape::Open : SectorShape::Closed, center, center, {}, {}, {}, {}};
  std::vector<Index> ring;
  for (const SectorPatch& sector : record.sectors)
    for (std::size_t i = 0; i < sector.face_count(); ++i) ring.push_back(mesh.wedge_vertex[sector.polygon[i]]);
  const SectorPatch& last = record.sectors.back();
  if (record.open_star) ring.push_back(mesh.wedge_vertex[last.polygon[last.face_count()]]);
  for (const Index v : ring) overlay.ring.push_back(Vec3(mesh.positions[v]));
  const auto number_of = [&](Index wedge) {
    return static_cast<std::uint8_t>(std::find(ring.begin(), ring.end(), mesh.wedge_vertex[wedge]) - ring.begin());
  };
  for (const SectorPatch& sector : record.sectors)
    for (const PolygonTriangle t : sector.triangles) {
      std::array<std::uint8_t, 3> c{number_of(sector.polygon[t.a]), number_of(sector.polygon[t.b]),
                                    number_of(sector.polygon[t.c])};
      std::sort(c.begin(), c.end());
      overlay.triangles.push_back({c[0], c[1], c[2]});
    }
  if (record.open_star) overlay.image = nearest_on_segment(center, overlay.ring.back(), overlay.ring.front());
  return overlay;
}

void project(Overlay& overlay, const Vec3& direction) {
  const Vec3 normal = normalized(direction);
  const Vec3 axis = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(axis, normal));
  const Vec3 w = cross(normal, u);
  const auto to_plane = [&](const Vec3& p) { return Vec2{dot(p - overlay.center, u), dot(p - overlay.center, w)}; };
  overlay.plane_ring.clear();
  for (const Vec3& p : overlay.ring) overlay.plane_ring.push_back(to_plane(p));
  overlay.plane_center = to_plane(overlay.image);
}

bool folds(const Overlay& overlay) {
  for (std::size_t i = 0; i < overlay.face_count(); ++i)
    if (!(cross2(overlay.plane_center, overlay.plane_ring[i], overlay.plane_ring[overlay.next(i)]) >= 0)) return true;
  return std::any_of(overlay.triangles.begin(), overlay.triangles.end(), [&](PolygonTriangle t) {
    return !(cross2(overlay.plane_ring[t.a], overlay.plane_ring[t.b], overlay.plane_ring[t.c]) > 0);
  });
}

/// The distance from the centre to the coarse surface's point over or under its image.
double center_displacement(const Overlay& overlay) {
  if (!(overlay.image == overlay.center)) return length(overlay.center - overlay.image);
  double best_inside = -std::numeric_limits<double>::infinity();
  Vec3 target;
  for (const PolygonTriangle t : overlay.triangles) {
    const std::array<std::size_t, 3> c{t.a, t.b, t.c};
    const double area = cross2(overlay.plane_ring[c[0]], overlay.plane_ring[c[1]], overlay.plane_ring[c[2]]);
    std::array<double, 3> weight{};
    for (std::size_t i = 0; i < 3; ++i)
      weight[i] =
          cross2(overlay.plane_center, overlay.plane_ring[c[(i + 1) % 3]], overlay.plane_ring[c[(i + 2) % 3]]) / area;
    const double inside = *std::min_element(weight.begin(), weight.end());
    if (inside <= best_inside) continue;
    best_inside = inside;
    target = overlay.ring[c[0]] * weight[0] + overlay.ring[c[1]] * weight[1] + overlay.ring[c[2]] * weight[2];
  }
  return length(overlay.center - target);
}

/// The distance between a spoke and a diagonal where their projections cross; 0 where they do not.
double crossing_displacement(const Overlay& overlay, std::size_t spoke, std::size_t a, std::size_t b) {
  const Vec2& c = overlay.plane_center;
  const Vec2& r = overlay.plane_ring[spoke];
  const Vec2& p = overlay.plane_ring[a];
  const Vec2& q = overlay.plane_ring[b];
  const double from = cross2(p, q, c);
  const double to = cross2(p, q, r);
  const double left = cross2(c, r, p);
  const double right = cross2(c, r, q);
  if (from * to > 0 || left * right > 0 || from == to || left == right) return 0;
  const double s = from / (from - to);
  const double t = left / (left - right);
  const Vec3 on_spoke = overlay.center + (overlay.ring[spoke] - overlay.center) * s;
  const Vec3 on_diagonal = overlay.ring[a] + (overlay.ring[b] - overlay.ring[a]) * t;
  return length(on_spoke - on_diagonal);
}

double overlay_displacement(const Overlay& overlay) {
  double largest = center_displacement(overlay);
  const std::size_t size = overlay.ring.size();
  for (const PolygonTriangle t : overlay.triangles) {
    for (const auto& [a, b] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.a, t.c}}) {
      for (std::size_t spoke = 0; spoke < size && !overlay.is_rim(a, b); ++spoke)
        if (spoke != a && spoke != b) largest = std::max(largest, crossing_displacement(overlay, spoke, a, b));
    }
  }
  return largest;
}

/// The point of the coarse faces nearest to the centre.
Vec3 nearest_coarse_point(const Overlay& overlay) {
  Vec3 nearest;
  double best = std::numeric_limits<double>::infinity();
  for (const PolygonTriangle t : overlay.triangles) {
    const Vec3 p = nearest_on_triangle(
        overlay.center, {to_float(overlay.ring[t.a]), to_float(overlay.ring[t.b]), to_float(overlay.ring[t.c])});
    if (squared_length(p - overlay.center) < best) best = squared_length(p - overlay.center), nearest = p;
  }
  return nearest;
}

/// The least bound that some direction of projection gives, with the centre where it is or slid to its nearest point;
/// infinity where every projection folds.
double overlay_bound(Overlay overlay) {
  if (overlay.triangles.empty()) return std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < 2; ++attempt) {
    for (const Vec3& direction : {fine_normal(overlay), coarse_normal(overlay)}) {
      project(overlay, direction);
      if (!folds(overlay)) return overlay_displacement(overlay);
    }
    if (overlay.shape != SectorShape::Closed) break;
    overlay.image = nearest_coarse_point(overlay);
  }
  return std::numeric_limits<double>::infinity();
}

double sector_bound(const Mesh& mesh, const SectorPatch& sector, const Vec3& center) {
  const Overlay overlay = make_overlay(mesh, sector, center);
  if (overlay.ring.size() == 2)
    return std::sqrt(squared_distance_to_segment(overlay.center, overlay.ring[0], overlay.ring[1]));
  if (sector.shape == SectorShape::Moved)
    return length(center - overlay.ring.back());  // each face moves with its corner
  return overlay_bound(overlay);
}

double longest_spoke(const Mesh& mesh, const RemovalRecord& record) {
  const Vec3 center(mesh.positions[record.vertex]);
  double longest = 0;
  for (const SectorPatch& sector : record.sectors)
    for (const Index wedge : sector.polygon)
      longest = std::max(longest, length(center - Vec3(mesh.positions[mesh.wedge_vertex[wedge]])));
  return longest;
}

/// The star's faces, and the coarse ones; a sector that has none leaves the edge at which the next face lies.
void gather_faces(const Mesh& mesh, const RemovalRecord& record, std::vector<Triangle>& fine,
                  std::vector<Triangle>& coarse) {
  for (const SectorPatch& sector : record.sectors) {
    const auto at = [&](std::size_t i) { return mesh.positions[mesh.wedge_vertex[sector.polygon[i]]]; };
    for (std::size_t i = 0; i < sector.face_count(); ++i)
      fine.push_back({mesh.positions[record.vertex], at(i), at(i + 1 < sector.polygon.size() ? i + 1 : 0)});
    for (const PolygonTriangle t : sector.triangles) coarse.push_back({at(t.a), at(t.b), at(t.c)});
    if (sector.polygon.size() == 2) coarse.push_back({at(0), at(1), at(1)});
  }
}

}  // namespace

double displacement_bound(const Mesh& mesh, const RemovalRecord& record) {
  const Vec3 center(mesh.positions[record.vertex]);
  double bound = 0;
  for (const SectorPatch& sector : record.sectors) bound = std::max(bound, sector_bound(mesh, sector, center));
  if (record.sectors.size() > 1) bound = std::min(bound, overlay_bound(make_overlay(mesh, record, center)));
  if (bound < longest_spoke(mesh, record)) return bound;
  std::vector<Triangle> fine;
  std::vector<Triangle> coarse;
  gather_faces(mesh, record, fine, coarse);
  return std::min(bound, patch_distance_bound(fine, coarse));
}

}  // namespace lodestone::detail

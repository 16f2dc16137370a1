// Polygons into triangles. Constrained Delaunay triangulation by GEOS, which clips ears and then turns edges: it adds
// no vertex, and leaves out no corner that lies straight between its neighbours, which would open a crack to the face
// beside it. It returns coordinates, by which the corners are found again; of corners at one place the first.

#include "mesh/polygon_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <memory>
#include <optional>
#include <utility>

#include <geos_c.h>

#include <lodestone/core/detail/finite.h>

namespace lodestone::detail {
namespace {

/// What clipping ears may cost for all polygons together, in cubed corners: some seconds at worst.
constexpr double kBudget = 2e11;
constexpr double kAreaTolerance = 1e-9;

struct Point2 {
  double x = 0, y = 0;
  friend auto operator<=>(const Point2&, const Point2&) = default;
};

/// Returns twice the area vector of a polygon, by Newell's sum around its first corner.
Vec3 newell_normal(std::span<const Vec3f> polygon) {
  Vec3 sum;
  const Vec3 origin(polygon[0]);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += cross(Vec3(polygon[i]) - origin, Vec3(polygon[i + 1]) - origin);
  return sum;
}

/// Leaves out the coordinate along which the polygon is thinnest, so that the others stay exact; the outline then runs
/// counter-clockwise. Nothing where the polygon has no area.
std::optional<std::vector<Point2>> project(std::span<const Vec3f> polygon) {
  const Vec3 normal = newell_normal(polygon);
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  if (!(x + y + z > 0) || !std::isfinite(x + y + z)) return std::nullopt;
  std::vector<Point2> points;
  points.reserve(polygon.size());
  for (const Vec3f& p : polygon) {
    Point2 point = x >= y && x >= z ? Point2{p.y, p.z} : y >= z ? Point2{p.z, p.x} : Point2{p.x, p.y};
    if ((x >= y && x >= z ? normal.x : y >= z ? normal.y : normal.z) < 0) point.x = -point.x;
    points.push_back(point);
  }
  return points;
}

double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
}

/// True where every corner turns left and the outline goes around once: where x changes direction twice.
bool is_strictly_convex(std::span<const Point2> points) {
  const std::size_t n = points.size();
  std::size_t direction_changes = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (!(turn(a, b, c) > 0)) return false;
    direction_changes += (b.x >= a.x) != (c.x >= b.x);
  }
  return direction_changes <= 2;
}

/// Twice the area, positive where the outline runs counter-clockwise.
double signed_area(std::span<const Point2> points) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) sum += turn(points[0], points[i], points[i + 1]);
  return sum;
}

/// Finds corners by their coordinates.
class CornerFinder {
 public:
  explicit CornerFinder(std::span<const Point2> points) {
    for (Index i = 0; i < points.size(); ++i) sorted_.emplace_back(points[i], i);
    std::sort(sorted_.begin(), sorted_.end());
  }

  /// Returns kNoIndex where there is none.
  Index find(const Point2& point) const {
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(point, Index{0}));
    return found != sorted_.end() && found->first == point ? found->second : kNoIndex;
  }

 private:
  std::vector<std::pair<Point2, Index>> sorted_;
};

/// GEOS for one polygon after the other.
class Triangulator {
 public:
  Triangulator() : context_(GEOS_init_r()) {}
  ~Triangulator() { GEOS_finish_r(context_); }
  Triangulator(const Triangulator&) = delete;
  Triangulator& operator=(const Triangulator&) = delete;

  /// Returns the numbers of the corners, three a triangle; nothing where the outline crosses itself.
  std::optional<std::vector<Index>> run(std::span<const Point2> points) {
    const Geometry polygon = make_polygon(points);
    if (!polygon) return std::nullopt;
    const Geometry triangles = own(GEOSConstrainedDelaunayTriangulation_r(context_, polygon.get()));
    if (!triangles) return std::nullopt;
    const CornerFinder finder(points);
    std::vector<Index> corners;
    const int count = GEOSGetNumGeometries_r(context_, triangles.get());
    for (int i = 0; i < count; ++i)
      if (!append_triangle(GEOSGetGeometryN_r(context_, triangles.get(), i), points, finder, corners))
        return std::nullopt;
    if (!covers(points, corners)) return std::nullopt;
    return corners;
  }

 private:
  struct Destroy {
    GEOSContextHandle_t context;
    void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(context, geometry); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;

  Geometry own(GEOSGeometry* geometry) const { return {geometry, Destroy{context_}}; }

  Geometry make_polygon(std::span<const Point2> points) {
    const std::size_t n = points.size();
    GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(context_, static_cast<unsigned>(n + 1), 2);
    if (sequence == nullptr) return own(nullptr);
    for (std::size_t i = 0; i <= n; ++i)
      GEOSCoordSeq_setXY_r(context_, sequence, static_cast<unsigned>(i), points[i % n].x, points[i % n].y);
    GEOSGeometry* ring = GEOSGeom_createLinearRing_r(context_, sequence);  // takes the sequence, as the next the ring
    return own(ring == nullptr ? nullptr : GEOSGeom_createPolygon_r(context_, ring, nullptr, 0));
  }

  /// Appends a triangle's corners counter-clockwise.
  bool append_triangle(const GEOSGeometry* triangle, std::span<const Point2> points, const CornerFinder& finder,
                       std::vector<Index>& corners) {
    const GEOSGeometry* ring = GEOSGetExteriorRing_r(context_, triangle);
    const GEOSCoordSequence* sequence = ring == nullptr ? nullptr : GEOSGeom_getCoordSeq_r(context_, ring);
    if (sequence == nullptr) return false;
    std::array<Index, 3> found{};
    for (unsigned k = 0; k < 3; ++k) {
      Point2 point;
      if (GEOSCoordSeq_getXY_r(context_, sequence, k, &point.x, &point.y) == 0) return false;
      found[k] = finder.find(point);
      if (found[k] == kNoIndex) return false;
    }
    if (turn(points[found[0]], points[found[1]], points[found[2]]) < 0) std::swap(found[1], found[2]);
    corners.insert(corners.end(), found.begin(), found.end());
    return true;
  }

  /// Triangles of outlines that cross themselves can leave parts out or overlap.
  static bool covers(std::span<const Point2> points, std::span<const Index> corners) {
    double sum = 0;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
      sum += turn(points[corners[i]], points[corners[i + 1]], points[corners[i + 2]]);
    const double area = signed_area(points);
    return std::abs(sum - area) <= kAreaTolerance * area;
  }

  GEOSContextHandle_t context_;
};

class Splitter {
 public:
  Splitter(std::span<const Vec3f> positions, SplitPolygons& out) : positions_(positions), out_(out) {}

  /// Adds a polygon whose corners are numbered from `first` on.
  void add(std::span<const Index> corners, Index first, Index number) {
    if (corners.size() < 3) {
      ++out_.short_count;
      return;
    }
    const auto triangles = corners.size() == 3 ? std::nullopt : triangulate(corners);
    if (triangles)
      for (const Index corner : *triangles) out_.corners.push_back(first + corner);
    else
      for (Index i = 1; i + 1 < corners.size(); ++i)
        for (const Index corner : {first, first + i, first + i + 1}) out_.corners.push_back(corner);
    out_.polygon.resize(out_.corners.size() / 3, number);
  }

 private:
  /// Returns nothing where a fan is right, or where there is nothing better.
  std::optional<std::vector<Index>> triangulate(std::span<const Index> corners) {
    polygon_.clear();
    for (const Index corner : corners) polygon_.push_back(positions_[corner]);
    if (!std::all_of(polygon_.begin(), polygon_.end(), is_finite)) return std::nullopt;
    const auto points = project(polygon_);
    if (!points || is_strictly_convex(*points)) return std::nullopt;
    const double cost = std::pow(static_cast<double>(points->size()), 3);
    auto triangles = cost > budget_ ? std::nullopt : triangulator_.run(*points);
    budget_ -= std::min(cost, budget_);
    out_.crossed_count += !triangles;
    return triangles;
  }

  std::span<const Vec3f> positions_;
  SplitPolygons& out_;
  std::vector<Vec3f> polygon_;
  Triangulator triangulator_;
  double budget_ = kBudget;
};

}  // namespace

SplitPolygons split_polygons(std::span<const Vec3f> positions, std::span<const Index> corners,
                             std::span<const Index> sizes) {
  SplitPolygons split;
  split.corners.reserve(corners.size());
  split.polygon.reserve(corners.size() / 3);
  Splitter splitter(positions, split);
  Index first = 0;
  for (Index number = 0; number < sizes.size(); ++number) {
    splitter.add(corners.subspan(first, sizes[number]), first, number);
    first += sizes[number];
  }
  return split;
}

}  // namespace lodestone::detail

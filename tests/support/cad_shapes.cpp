#include "support/cad_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "support/soup_building.h"

namespace lodestone::test {
namespace {

struct Point2 {
  double x = 0;
  double y = 0;
};
using Loop = std::vector<Point2>;

/// A flat region: one loop around it, counter-clockwise, and holes, clockwise.
struct Outline {
  Loop outer;
  std::vector<Loop> holes;
};

/// n points on an arc from one angle towards another, both in turns; the last is left out.
void add_arc(Loop& loop, Point2 center, double radius, double from, double to, int n) {
  for (int i = 0; i < n; ++i) {
    const double angle = kTurn * (from + (to - from) * i / n);
    loop.push_back({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)});
  }
}

Loop circle(Point2 center, double radius, int n) {
  Loop loop;
  add_arc(loop, center, radius, 0, 1, n);
  return loop;
}

/// The same points the other way around.
Loop hole(Point2 center, double radius, int n) {
  Loop loop = circle(center, radius, n);
  std::reverse(loop.begin(), loop.end());
  return loop;
}

double side_of(const Point2& a, const Point2& b, const Point2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Cuts flat regions into triangles as simple programs do: the first ear there is goes, however thin.
class EarClipper {
 public:
  explicit EarClipper(const Outline& outline) {
    add_loop(outline.outer, ring_);
    std::vector<std::vector<std::size_t>> holes;
    for (const Loop& hole : outline.holes) add_loop(hole, holes.emplace_back());
    const auto rightmost = [&](const std::vector<std::size_t>& hole) { return points_[*farthest_right(hole)].x; };
    std::sort(holes.begin(), holes.end(), [&](const auto& a, const auto& b) { return rightmost(a) > rightmost(b); });
    for (const auto& hole : holes) bridge(hole);
  }

  /// Triangles of points, numbered loop after loop.
  std::vector<std::array<std::size_t, 3>> triangles() {
    std::vector<std::array<std::size_t, 3>> result;
    for (std::size_t i = 0; ring_.size() > 2;) {
      const std::size_t n = ring_.size();
      std::size_t tried = 0;
      while (tried < n && !is_ear(i % n)) ++i, ++tried;
      if (tried == n) return {};  // never, where loops neither touch nor cross
      i %= n;
      result.push_back({ring_[(i + n - 1) % n], ring_[i], ring_[(i + 1) % n]});
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return result;
  }

 private:
  void add_loop(const Loop& loop, std::vector<std::size_t>& ring) {
    for (const Point2& p : loop) {
      ring.push_back(points_.size());
      points_.push_back(p);
    }
  }

  std::vector<std::size_t>::const_iterator farthest_right(const std::vector<std::size_t>& hole) const {
    return std::max_element(hole.begin(), hole.end(),
                            [&](std::size_t a, std::size_t b) { return points_[a].x < points_[b].x; });
  }

  /// Joins a hole to the ring by an edge there and back, from its rightmost point to the nearest that it sees.
  void bridge(const std::vector<std::size_t>& hole) {
    const auto start = farthest_right(hole);
    const Point2& from = points_[*start];
    std::size_t best = ring_.size();
    double least = 0;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point2& to = points_[ring_[i]];
      const double distance = std::hypot(to.x - from.x, to.y - from.y);
      if (to.x <= from.x || (best < ring_.size() && distance >= least) || !sees(from, to)) continue;
      best = i;
      least = distance;
    }
    std::vector<std::size_t> detour;
    for (std::size_t i = 0; i <= hole.size(); ++i)
      detour.push_back(hole[(static_cast<std::size_t>(start - hole.begin()) + i) % hole.size()]);
    detour.push_back(ring_[best]);
    ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(best + 1), detour.begin(), detour.end());
  }

  bool sees(const Point2& from, const Point2& to) const {
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point2& a = points_[ring_[i]];
      const Point2& b = points_[ring_[(i + 1) % ring_.size()]];
      if (side_of(from, to, a) * side_of(from, to, b) < 0 && side_of(a, b, from) * side_of(a, b, to) < 0) return false;
    }
    return true;
  }

  bool is_ear(std::size_t i) const {
    const std::size_t n = ring_.size();
    const Point2& a = points_[ring_[(i + n - 1) % n]];
    const Point2& b = points_[ring_[i]];
    const Point2& c = points_[ring_[(i + 1) % n]];
    if (side_of(a, b, c) <= 1e-12) return false;
    const auto same = [](const Point2& p, const Point2& q) { return p.x == q.x && p.y == q.y; };
    return std::none_of(ring_.begin(), ring_.end(), [&](std::size_t k) {
      const Point2& p = points_[k];
      if (same(p, a) || same(p, b) || same(p, c)) return false;
      return side_of(a, b, p) >= 0 && side_of(b, c, p) >= 0 && side_of(c, a, p) >= 0;
    });
  }

  std::vector<Point2> points_;
  std::vector<std::size_t> ring_;
};

/// Adds a flat region at height z, facing up or down, over points that are there: `first` is that of its first loop.
void add_region(TriangleSoup& soup, const Outline& outline, Index first, bool up) {
  for (const auto& t : EarClipper(outline).triangles()) {
    const auto at = [&](std::size_t k) { return first + static_cast<Index>(t[k]); };
    add_triangle(soup, at(0), at(up ? 1 : 2), at(up ? 2 : 1));
  }
}

/// Adds an outline's points at height z and returns the first.
Index add_outline_points(TriangleSoup& soup, const Outline& outline, double z) {
  const auto first = static_cast<Index>(soup.positions.size());
  for (const Point2& p : outline.outer) add_point(soup, p.x, p.y, z);
  for (const Loop& hole : outline.holes)
    for (const Point2& p : hole) add_point(soup, p.x, p.y, z);
  return first;
}

/// Adds two triangles between each point of a loop and the next, from ring `low` up to ring `high`.
void add_wall(TriangleSoup& soup, std::size_t n, Index low, Index high) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = [&](Index first, std::size_t k) { return first + static_cast<Index>(k % n); };
    add_square(soup, at(low, i), at(low, i + 1), at(high, i + 1), at(high, i));
  }
}

TriangleSoup prism(const Outline& outline, double height) {
  TriangleSoup soup;
  Index low = add_outline_points(soup, outline, 0);
  Index high = add_outline_points(soup, outline, height);
  add_region(soup, outline, low, false);
  add_region(soup, outline, high, true);
  add_wall(soup, outline.outer.size(), low, high);
  low += static_cast<Index>(outline.outer.size());
  high += static_cast<Index>(outline.outer.size());
  for (const Loop& hole : outline.holes) {
    add_wall(soup, hole.size(), low, high);
    low += static_cast<Index>(hole.size());
    high += static_cast<Index>(hole.size());
  }
  return soup;
}

/// Turns a profile of (radius, height) about the z axis, going up; where it starts and ends, flat fans close it.
TriangleSoup revolved(const Loop& profile, int sides) {
  TriangleSoup soup;
  const auto n = static_cast<Index>(sides);
  for (const Point2& p : profile)
    for (const Point2& q : circle({0, 0}, p.x, sides)) add_point(soup, q.x, q.y, p.y);
  for (Index j = 0; j + 1 < profile.size(); ++j) add_wall(soup, n, j * n, (j + 1) * n);
  const auto last = static_cast<Index>(profile.size() - 1) * n;
  for (Index i = 1; i + 1 < n; ++i) {
    add_triangle(soup, 0, i + 1, i);
    add_triangle(soup, last, last + i, last + i + 1);
  }
  return soup;
}

/// A cross-section of a pipe: its middle, and the direction in the xy plane that the pipe goes in.
struct Section {
  Point2 middle;
  double direction = 0;  // in turns
};

std::vector<Section> pipe_path(int elbow_steps) {
  std::vector<Section> path = {{{0, 0}, 0}};
  for (int i = 0; i <= elbow_steps; ++i) {
    const double turn = 0.25 * i / elbow_steps;
    path.push_back({{4 + std::sin(kTurn * turn), 1 - std::cos(kTurn * turn)}, turn});
  }
  for (int i = 0; i <= elbow_steps; ++i) {
    const double turn = 0.25 * i / elbow_steps;
    path.push_back({{6 - std::cos(kTurn * turn), 4 + std::sin(kTurn * turn)}, 0.25 - turn});
  }
  path.push_back({{9, 5}, 0});
  return path;
}

constexpr double kThreadRadius = 0.4;
constexpr double kPitch = 0.3;

/// A thread's point, as (radius, height): i-th of its sides, j-th quarter of a pitch along the helix, cut off flat at
/// both ends.
Point2 thread_profile(int i, int j, int turns, int sides) {
  const int pitch = 4 * sides;
  const int height = std::clamp(j * sides + 4 * i - pitch, 0, turns * pitch);
  const bool is_cut = height == 0 || height == turns * pitch;
  return {is_cut || j % 4 < 2 ? kThreadRadius : kThreadRadius + 0.1, kPitch * (static_cast<double>(height) / pitch)};
}

}  // namespace

TriangleSoup cut_box(int n) {
  Outline outline;
  const Point2 corners[] = {{0, 0}, {3, 0}, {3, 2}, {0, 2}};
  for (int k = 0; k < 4; ++k) {
    const Point2& a = corners[k];
    const Point2& b = corners[(k + 1) % 4];
    for (int i = 0; i < n; ++i) outline.outer.push_back({a.x + (b.x - a.x) * i / n, a.y + (b.y - a.y) * i / n});
  }
  return prism(outline, 1);
}

TriangleSoup rounded_plate(int arc, int n) {
  constexpr double kRadius = 0.2;
  const Point2 corners[] = {
      {3 - kRadius, kRadius}, {3 - kRadius, 2 - kRadius}, {kRadius, 2 - kRadius}, {kRadius, kRadius}};
  Outline outline;
  for (int k = 0; k < 4; ++k) {
    add_arc(outline.outer, corners[k], kRadius, 0.25 * (k - 1), 0.25 * k, arc);
    Loop straight;  // from the end of this arc to the start of the next
    add_arc(straight, corners[k], kRadius, 0.25 * k, 0, 1);
    add_arc(straight, corners[(k + 1) % 4], kRadius, 0.25 * k, 0, 1);
    for (int i = 0; i <= n; ++i) {
      const double t = static_cast<double>(i) / (n + 1);
      outline.outer.push_back(
          {straight[0].x + (straight[1].x - straight[0].x) * t, straight[0].y + (straight[1].y - straight[0].y) * t});
    }
  }
  return prism(outline, 0.3);
}

TriangleSoup crowded_box(int n) {
  return box_of_squares(n, [&](const std::array<int, 3>& at, Index) {
    const auto crowd = [&](int i) { return std::pow(static_cast<double>(i) / n, 4.0); };
    return std::array<double, 3>{3 * crowd(at[0]), 2 * crowd(at[1]), crowd(at[2])};
  });
}

TriangleSoup rod(int sides) { return revolved({{0.01, 0}, {0.01, 1}}, sides); }

TriangleSoup disc(int sides) { return revolved({{3, 0}, {3, 0.1}}, sides); }

TriangleSoup drilled_plate(int columns, int rows, int sides) {
  Outline outline{{{0, 0}, {1.0 * columns, 0}, {1.0 * columns, 1.0 * rows}, {0, 1.0 * rows}}, {}};
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j)
      outline.holes.push_back(hole({i + 0.5, j + 0.5 + 0.02 * i}, 0.2 + 0.1 * ((i + j) % 2), sides));
  return prism(outline, 0.2);
}

TriangleSoup rounded_box(int n) {
  return box_of_squares(2 * n + 1, [&](const std::array<int, 3>& at, Index) {
    constexpr double kRadius = 0.2;
    const std::array<double, 3> half = {1.5, 1, 0.5};
    std::array<double, 3> offset{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int steps = at[k] <= n ? at[k] - n : at[k] - n - 1;  // from the flat part outwards
      offset[k] = std::tan(kTurn / 8 * steps / n);
    }
    const double length = std::hypot(offset[0], offset[1], offset[2]);
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = (at[k] <= n ? -half[k] : half[k]) + kRadius * offset[k] / length;
    return p;
  });
}

TriangleSoup turned_shaft(int sides) {
  Loop profile = {{0.3, 0}, {0.4, 0.1}, {0.4, 2}};
  for (int i = 1; i <= 4; ++i) {  // a fillet up to the flange
    const double angle = kTurn / 4 * i / 4;
    profile.push_back({0.6 - 0.2 * std::cos(angle), 2 + 0.2 * std::sin(angle)});
  }
  for (const Point2 p : {Point2{1, 2.2},
                         {1.1, 2.3},
                         {1.1, 2.5},
                         {0.5, 2.5},
                         {0.5, 5},
                         {0.45, 5},
                         {0.45, 5.1},
                         {0.5, 5.1},
                         {0.5, 5.9},
                         {0.4, 6}})
    profile.push_back(p);
  return revolved(profile, sides);
}

TriangleSoup gear(int teeth, int n) {
  Outline outline;
  for (int tooth = 0; tooth < teeth; ++tooth) {
    const auto at = [&](double share) { return (tooth + share) / teeth; };
    add_arc(outline.outer, {0, 0}, 2, at(0), at(0.4), n);
    for (int i = 0; i < n; ++i) {  // a flank that bends as it rises
      const double rise = static_cast<double>(i) / n;
      add_arc(outline.outer, {0, 0}, 2 + 0.5 * rise, at(0.4 + 0.12 * rise * rise), 0, 1);
    }
    add_arc(outline.outer, {0, 0}, 2.5, at(0.52), at(0.88), n);
    for (int i = 0; i < n; ++i) {
      const double rise = 1 - static_cast<double>(i) / n;
      add_arc(outline.outer, {0, 0}, 2 + 0.5 * rise, at(1 - 0.12 * rise * rise), 0, 1);
    }
  }
  outline.holes.push_back(hole({0, 0}, 0.7, 8 * n));
  return prism(outline, 0.8);
}

TriangleSoup bent_pipe(int sides, int elbow_steps) {
  TriangleSoup soup;
  const std::vector<Section> path = pipe_path(elbow_steps);
  for (const double radius : {0.4, 0.5})
    for (const Section& section : path)
      for (const Point2& p : circle({0, 0}, radius, sides))
        add_point(soup, section.middle.x + p.x * std::sin(kTurn * section.direction),
                  section.middle.y - p.x * std::cos(kTurn * section.direction), p.y);
  const auto n = static_cast<Index>(sides);
  const auto rings = static_cast<Index>(path.size());
  for (Index j = 0; j + 1 < rings; ++j) {
    add_wall(soup, n, j * n, (j + 1) * n);
    add_wall(soup, n, (rings + j + 1) * n, (rings + j) * n);
  }
  add_wall(soup, n, rings * n, 0);
  add_wall(soup, n, (rings - 1) * n, (2 * rings - 1) * n);
  return soup;
}

TriangleSoup screw(int turns, int sides) {
  TriangleSoup soup;
  const int rows = 4 * (turns + 1);
  const auto n = static_cast<Index>(sides);
  const Loop unit = circle({0, 0}, 1, sides);
  for (int j = 0; j <= rows + 4; ++j)
    for (int i = 0; i < sides; ++i) {
      const Point2 p = thread_profile(i, j, turns, sides);
      add_point(soup, p.x * unit[static_cast<std::size_t>(i)].x, p.x * unit[static_cast<std::size_t>(i)].y, p.y);
    }
  const auto at = [&](Index i, Index j) { return i < n ? j * n + i : (j + 4) * n + i - n; };
  for (Index j = 0; j < static_cast<Index>(rows); ++j)
    for (Index i = 0; i < n; ++i) add_square(soup, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  for (Index i = 1; i + 1 < n; ++i) add_triangle(soup, 0, i + 1, i);
  // The head: a hexagon around the thread's end, its wall, and its top.
  const Outline below{circle({0, 0}, 1, 6), {hole({0, 0}, kThreadRadius, sides)}};
  const Outline above{below.outer, {}};
  const Index low = add_outline_points(soup, below, kPitch * turns);
  const Index high = add_outline_points(soup, above, kPitch * turns + 0.5);
  add_region(soup, below, low, false);
  add_wall(soup, 6, low, high);
  add_region(soup, above, high, true);
  return soup;
}

TriangleSoup askew(TriangleSoup soup) {
  const Vec3 x = normalized({0.8, 0.5, -0.3});
  const Vec3 y = normalized(cross({0.1, 0.2, 1}, x));
  const Vec3 z = cross(x, y);
  for (Vec3f& p : soup.positions) {
    const Vec3 q = x * static_cast<double>(p.x) + y * static_cast<double>(p.y) + z * static_cast<double>(p.z);
    p = to_float(q);
  }
  return soup;
}

std::vector<CadShape> cad_shapes(int detail) {
  const int d = detail;
  std::vector<CadShape> shapes = {
      {"cut-box", cut_box(12 * d)},
      {"crowded-box", crowded_box(4 + 2 * d)},
      {"rounded-plate", rounded_plate(4 * d, 8 * d)},
      {"rod", rod(48 * d)},
      {"disc", disc(48 * d)},
      {"drilled-plate", drilled_plate(2 * d, 2, 12)},
      {"rounded-box", rounded_box(1 + d)},
      {"turned-shaft", turned_shaft(10 * d)},
      {"gear", gear(6 * d, 3)},
      {"bent-pipe", bent_pipe(10 * d, 3 + d)},
      {"screw", screw(1 + d, 12 + 2 * d)},
  };
  const std::size_t count = shapes.size();
  for (std::size_t i = 0; i < count; ++i) shapes.push_back({"askew-" + shapes[i].name, askew(shapes[i].soup)});
  return shapes;
}

}  // namespace lodestone::test

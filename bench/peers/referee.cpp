// P. Cignoni, C. Rocchini, R. Scopigno: Metro: measuring error on simplified surfaces. Computer Graphics Forum 17(2),
// 1998.
//
// Metro's default: ten samples for each face of the larger mesh, 100,000 at least; one at each vertex, the same number
// on a unit of length of the edges as on a unit of length of the area, the rest over the faces. It draws at random;
// here the samples of edges and faces stand at equal steps of accumulated length and area, so that every run is the
// same. Of edges and faces only a share is taken where Metro would take more samples than asked for; vertices then
// weigh as much less, so that means stay what they are.
//
// Departure: where faces are thinner than the step, edges lie so close that they would take all samples, none would be
// between them, and what was turned about edges that it kept would seem to have no error. There an edge gets the fewer
// the closer its neighbours lie, and the faces get the rest.

#include "referee.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace lodestone::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kSliverAngle = 1;          // degrees
constexpr std::size_t kSamplesOfFace = 10;  // Metro's
constexpr double kFewestOfArea = 20'000;
constexpr std::size_t kMinSamples = 100'000;  // Metro's
constexpr double kLeastWidth = 1.2;           // of an edge's faces, in steps between its samples

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x, p.y, p.z}; }

struct Corners {
  Vec3 a, b, c;
  Vec3 area_normal() const { return cross(b - a, c - a) * 0.5; }
};

Corners corners_of(const Surface& surface, std::size_t face) {
  const auto& f = surface.faces[face];
  return {surface.points[f[0]], surface.points[f[1]], surface.points[f[2]]};
}

/// A surface with a tree over its faces. Faces without area are left out: their points are on their neighbours, too.
class Target {
 public:
  explicit Target(const Surface& surface) {
    for (std::size_t f = 0; f < surface.faces.size(); ++f) {
      const Corners t = corners_of(surface, f);
      const Vec3 normal = normalized(t.area_normal());
      if (normal == Vec3{}) continue;
      triangles_.emplace_back(to_cgal(t.a), to_cgal(t.b), to_cgal(t.c));
      normals_.push_back(normal);
    }
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.accelerate_distance_queries();
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  bool empty() const { return triangles_.empty(); }

  struct Hit {
    double distance;
    Vec3 normal;
  };

  /// Returns the nearest point; fast where queries follow one another closely.
  Hit nearest(const Vec3& p) {
    const Kernel::Point_3 query = to_cgal(p);
    last_ = last_ ? tree_.closest_point_and_primitive(query, *last_) : tree_.closest_point_and_primitive(query);
    const auto face = static_cast<std::size_t>(last_->second - triangles_.cbegin());
    return {std::sqrt(CGAL::squared_distance(query, last_->first)), normals_[face]};
  }
  /// Forgets where the last query was: the next one lies elsewhere.
  void jump() { last_.reset(); }

 private:
  Triangles triangles_;
  std::vector<Vec3> normals_;
  Tree tree_;
  std::optional<Tree::Point_and_primitive_id> last_;
};

/// An edge of a surface.
struct EdgeOf {
  Index from, to;
  double area;  // of its faces
};

/// The edges of a surface, each once. Not by the table that lodestone uses: the referee has none of its code.
std::vector<EdgeOf> edges_of(const Surface& surface) {
  std::vector<EdgeOf> edges;
  edges.reserve(surface.faces.size() * 3);
  for (std::size_t i = 0; i < surface.faces.size(); ++i) {
    const auto& f = surface.faces[i];
    const double area = length(corners_of(surface, i).area_normal());
    for (int k = 0; k < 3; ++k) {
      const auto [from, to] = std::minmax(f[k], f[(k + 1) % 3]);
      edges.push_back({from, to, area});
    }
  }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const EdgeOf& a, const EdgeOf& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); });
  std::vector<EdgeOf> distinct;
  for (const EdgeOf& edge : edges) {
    if (!distinct.empty() && distinct.back().from == edge.from && distinct.back().to == edge.to)
      distinct.back().area += edge.area;
    else
      distinct.push_back(edge);
  }
  return distinct;
}

std::vector<Index> used_points(const Surface& surface) {
  std::vector<char> used(surface.points.size(), 0);
  for (const auto& f : surface.faces) {
    for (const Index i : f) used[i] = 1;
  }
  std::vector<Index> points;
  for (Index i = 0; i < used.size(); ++i) {
    if (used[i]) points.push_back(i);
  }
  return points;
}

/// Sums of distances and angles with their weights.
struct Totals {
  double weight = 0, sum = 0, squares = 0, maximum = 0;
  double area_weight = 0, angles = 0;

  void add(double distance, double w) {
    weight += w;
    sum += w * distance;
    squares += w * distance * distance;
    maximum = std::max(maximum, distance);
  }
  void add_angle(double angle) {
    area_weight += 1;
    angles += angle;
  }
  OneWay result() const {
    return {sum / weight, std::sqrt(squares / weight), maximum, area_weight > 0 ? angles / area_weight * kDegrees : 0};
  }
};

/// Samples one surface against a target.
class Sampler {
 public:
  /// `larger_face_count`: of the two meshes, as Metro counts; `samples`: what may be taken in all.
  Sampler(const Surface& surface, Target& target, std::size_t larger_face_count, std::size_t samples)
      : surface_(surface), target_(target), points_(used_points(surface)) {
    for (std::size_t f = 0; f < surface.faces.size(); ++f) area_ += length(corners_of(surface, f).area_normal());
    const double metro = static_cast<double>(std::max(kMinSamples, kSamplesOfFace * larger_face_count));
    share_ = std::min(1.0, static_cast<double>(samples) / metro);
    rest_ = std::max(0.0, metro - static_cast<double>(points_.size()));
  }

  OneWay run() {
    vertices();
    rest_ = std::max(0.0, rest_ - edges());
    faces();
    return totals_.result();
  }

 private:
  void vertices() {
    target_.jump();
    for (const Index i : points_) totals_.add(target_.nearest(surface_.points[i]).distance, share_);
  }

  /// Returns how many samples Metro takes of edges.
  double edges() {
    const double density = area_ > 0 ? std::sqrt(rest_ / area_) : 0;  // samples for each unit of length
    double total = 0;
    double due = 0.5;
    const double least_width = density > 0 ? kLeastWidth / density : 0;
    for (const auto& [from, to, area] : edges_of(surface_)) {
      const Vec3 a = surface_.points[from];
      const Vec3 b = surface_.points[to];
      const double size = length(b - a);
      const double narrow = std::min(1.0, size > 0 ? area / (size * least_width) : 0);
      const double count = size * density * narrow * narrow;
      total += count;
      const double taken = count * share_;
      if (due < taken) target_.jump();
      for (; due < taken; due += 1) totals_.add(target_.nearest(a + (b - a) * (due / taken)).distance, 1);
      due -= taken;
    }
    return total;
  }

  void faces() {
    if (area_ <= 0) return;
    // Where faces are thin, edges use up all that Metro would take; angles need samples of the area all the same.
    const double of_metro = rest_ * share_;
    const double count = std::max(of_metro, kFewestOfArea);
    const double density = count / area_;
    // A sequence of low discrepancy in the unit square, folded into the triangle: (k/ρ, k/ρ²), ρ³ = ρ + 1.
    constexpr double kStepU = 0.7548776662466927;
    constexpr double kStepV = 0.5698402909980532;
    double u = 0.5;
    double v = 0.5;
    double due = 0.5;
    for (std::size_t f = 0; f < surface_.faces.size(); ++f) {
      const Corners t = corners_of(surface_, f);
      const Vec3 normal = t.area_normal();
      const double taken = length(normal) * density;
      if (due < taken) target_.jump();
      for (; due < taken; due += 1) {
        u = std::fmod(u + kStepU, 1);
        v = std::fmod(v + kStepV, 1);
        const bool fold = u + v > 1;
        const Vec3 p = t.a + (t.b - t.a) * (fold ? 1 - u : u) + (t.c - t.a) * (fold ? 1 - v : v);
        const auto hit = target_.nearest(p);
        totals_.add(hit.distance, of_metro / count);
        totals_.add_angle(angle_between(normal, hit.normal));
      }
      due -= taken;
    }
  }

  const Surface& surface_;
  Target& target_;
  std::vector<Index> points_;
  double area_ = 0;
  double share_ = 1;  // of Metro's samples
  double rest_ = 0;   // Metro's samples that are not yet given out
  Totals totals_;
};

OneWay sample(const Surface& from, Target& to, std::size_t larger_face_count, std::size_t samples) {
  return Sampler(from, to, larger_face_count, samples).run();
}

double smallest_angle(const Corners& t) {
  const double at_a = angle_between(t.b - t.a, t.c - t.a);
  const double at_b = angle_between(t.c - t.b, t.a - t.b);
  return std::min({at_a, at_b, std::max(0.0, std::numbers::pi - at_a - at_b)}) * kDegrees;
}

/// Numbers points so that those with equal coordinates share one: copies along cuts and seams are one place.
std::vector<Index> places_of(const Surface& surface) {
  std::map<std::tuple<double, double, double>, Index> place;
  std::vector<Index> places;
  places.reserve(surface.points.size());
  for (const Vec3& p : surface.points) {
    places.push_back(place.try_emplace({p.x, p.y, p.z}, static_cast<Index>(place.size())).first->second);
  }
  return places;
}

std::size_t nonmanifold_edges(const Surface& surface) {
  const std::vector<Index> places = places_of(surface);
  std::vector<std::pair<Index, Index>> edges;
  for (const auto& f : surface.faces) {
    for (int i = 0; i < 3; ++i) edges.push_back(std::minmax(places[f[i]], places[f[(i + 1) % 3]]));
  }
  std::sort(edges.begin(), edges.end());
  std::size_t count = 0;
  for (auto i = edges.begin(); i != edges.end();) {
    const auto next = std::upper_bound(i, edges.end(), *i);
    if (next - i > 2) ++count;
    i = next;
  }
  return count;
}

struct Angles {
  double mean_minimum = 0;
  std::size_t slivers = 0;
};

Angles angles_of(const Surface& surface) {
  Angles angles;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    const double smallest = smallest_angle(corners_of(surface, f));
    angles.mean_minimum += smallest / static_cast<double>(surface.faces.size());
    if (smallest < kSliverAngle) ++angles.slivers;
  }
  return angles;
}

/// Returns whether a face looks away from the original all over: a large one that cuts through a thin part does so only
/// here and there, where the part's other side is the nearer one.
bool is_flipped(const Corners& t, Target& original) {
  const Vec3 normal = t.area_normal();
  const Vec3 centre = (t.a + t.b + t.c) * (1.0 / 3);
  original.jump();
  for (const Vec3& p :
       {centre, (centre + t.a * 2) * (1.0 / 3), (centre + t.b * 2) * (1.0 / 3), (centre + t.c * 2) * (1.0 / 3)}) {
    if (dot(original.nearest(p).normal, normal) >= 0) return false;
  }
  return true;
}

std::size_t flipped_faces(const Surface& surface, Target& original) {
  std::size_t count = 0;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    if (is_flipped(corners_of(surface, f), original)) ++count;
  }
  return count;
}

std::size_t beyond(std::size_t count, std::size_t of_original) { return count > of_original ? count - of_original : 0; }

}  // namespace

struct Referee::Impl {
  Surface original;
  std::size_t samples;
  double diagonal;
  std::size_t nonmanifold;
  std::size_t slivers;
  mutable Target target;  // mutable: it remembers the last query

  Impl(Surface surface, std::size_t sample_limit)
      : original(std::move(surface)),
        samples(sample_limit),
        diagonal(diagonal_of(original)),
        nonmanifold(nonmanifold_edges(original)),
        slivers(angles_of(original).slivers),
        target(original) {}

  std::size_t larger(const Surface& other) const { return std::max(original.faces.size(), other.faces.size()); }
};

Referee::Referee(Surface original, std::size_t samples) : impl_(std::make_unique<Impl>(std::move(original), samples)) {}
Referee::~Referee() = default;
Referee::Referee(Referee&&) noexcept = default;

OneWay Referee::forward(const Surface& simplified) const {
  Target target(simplified);
  if (target.empty()) return {INFINITY, INFINITY, INFINITY, 180};
  return sample(impl_->original, target, impl_->larger(simplified), impl_->samples);
}

OneWay Referee::backward(const Surface& simplified) const {
  if (simplified.faces.empty()) return {INFINITY, INFINITY, INFINITY, 180};
  return sample(simplified, impl_->target, impl_->larger(simplified), impl_->samples);
}

Judgement Referee::judge(const Surface& simplified) const {
  const OneWay there = forward(simplified);
  const OneWay back = backward(simplified);
  const double percent = 100 / impl_->diagonal;
  const Angles angles = angles_of(simplified);
  Judgement judgement;
  judgement.faces = simplified.faces.size();
  judgement.mean = (there.mean + back.mean) / 2 * percent;
  judgement.rms = (there.rms + back.rms) / 2 * percent;
  judgement.maximum = std::max(there.maximum, back.maximum) * percent;
  judgement.normal_angle = there.normal_angle;
  judgement.minimum_angle = angles.mean_minimum;
  judgement.nonmanifold_edges = beyond(nonmanifold_edges(simplified), impl_->nonmanifold);
  judgement.flipped_faces = flipped_faces(simplified, impl_->target);
  judgement.sliver_faces = beyond(angles.slivers, impl_->slivers);
  return judgement;
}

}  // namespace lodestone::bench

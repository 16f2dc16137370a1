// Mean and root mean square by the samples of P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on
// simplified surfaces", Computer Graphics Forum 17(2), 1998: vertices, edges and faces, each sample counting once. How
// many of each Metro would take is computed first; as many as are wanted are then taken, and weighted to count for as
// many as Metro's. They are always the same: at equal steps of length and area, and within the faces by M. Roberts'
// quasirandom sequence R2 ("The unreasonable effectiveness of quasirandom sequences", 2018). The maximum is not left to
// the samples, see supremum.cpp.
//
// Departure: where faces are thinner than the step of Metro's samples, edges lie so close that they would take all of
// them; none would lie between, and a surface that keeps the edges would seem to have no error. There an edge gets the
// fewer the closer its neighbours lie, and the faces get the rest.

#include <lodestone/lod/deviation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/detail/edges.h>

#include "distance/coincident_faces.h"
#include "distance/even_steps.h"
#include "distance/morton_curve.h"
#include "distance/supremum.h"
#include "distance/triangle.h"

namespace lodestone {
namespace {

using detail::add_up;
using detail::CoincidentFaces;
using detail::Edge;
using detail::for_each_edge;
using detail::Goal;
using detail::HalfEdge;
using detail::kSamplesOfStep;
using detail::PatchBound;
using detail::sorted_edges;
using detail::step_through;
using detail::SupremumSearch;
using detail::SurfaceBounds;
using detail::TargetSurface;

constexpr double kMetrosSamplesPerFace = 10;  // Of the larger mesh: Metro's default.
constexpr double kLeastSamples = 100'000;     // Metro's default would leave small meshes without any in their faces.
constexpr double kLeastFaceShare = 0.125;
constexpr double kMeansShare = 0.4;  // Of the work, each way; the maximum takes the rest.
constexpr double kLeastWidth = 1.2;  // Of an edge's faces, in steps; an edge of narrower ones gets fewer samples.

double area_of(const Mesh& mesh, Index face) { return 0.5 * length(area_vector(mesh, face)); }

}  // namespace

struct MeasuredSurface::Impl {
  /// An edge of any number of faces.
  struct EdgeFaces {
    Index corner;  // The first on it.
    double area;   // Of its faces.
  };

  explicit Impl(const Mesh& given)
      : mesh(given),
        index(given),
        box(bounding_box(given)),
        opposite(detail::opposite_corners(given)),
        edges(list_edges(given)) {}

  static std::vector<EdgeFaces> list_edges(const Mesh& mesh);

  const Mesh& mesh;
  SurfaceIndex index;
  Box box;
  std::vector<Index> opposite;
  std::vector<EdgeFaces> edges;  // In the order of the faces.
};

/// Returns each edge once, however many faces it has.
std::vector<MeasuredSurface::Impl::EdgeFaces> MeasuredSurface::Impl::list_edges(const Mesh& mesh) {
  std::vector<EdgeFaces> edges;
  const std::vector<HalfEdge> halves = sorted_edges(mesh);
  for_each_edge(halves, [&](Edge edge) {
    double area = 0;
    for (const HalfEdge& half : edge) area += area_of(mesh, face_of_corner(half.corner));
    edges.push_back({edge.front().corner, area});
  });
  std::sort(edges.begin(), edges.end(), [](const EdgeFaces& a, const EdgeFaces& b) { return a.corner < b.corner; });
  return edges;
}

namespace {

using Surface = MeasuredSurface::Impl;

/// The vertices that faces use, the edges and the faces of a mesh, with points on each.
class Samples {
 public:
  /// `metros_count`: how many samples Metro is asked for.
  Samples(const Surface& surface, double metros_count) : surface_(surface), mesh_(surface.mesh) {
    face_until_.resize(mesh_.face_count());
    for (Index f = 0; f < mesh_.face_count(); ++f) face_until_[f] = area_of(mesh_, f);
    const double area = add_up(face_until_);
    find_vertices();
    counts_.vertices = static_cast<double>(vertices_.size());
    const double rest = std::max(metros_count - counts_.vertices, 0.0);
    const double per_length = area > 0 ? std::sqrt(rest / area) : 0;
    const double edge_length = find_edges(per_length > 0 ? kLeastWidth / per_length : 0);
    counts_.edges = area > 0 ? std::min(edge_length * per_length, rest) : rest;
    counts_.faces = rest - counts_.edges;
  }

  /// How many samples Metro takes of each kind.
  struct Counts {
    double vertices = 0, edges = 0, faces = 0;
  };
  const Counts& metros_counts() const { return counts_; }

  /// Each calls `visit(point, face)`, with a face that the point is on, for `count` samples spread evenly.
  template <class Visit>
  void for_vertices(std::size_t count, const Visit& visit) const {
    for (std::size_t k = 0; k < count; ++k) {
      const Index corner = vertices_[(2 * k + 1) * vertices_.size() / (2 * count)];
      visit(mesh_.corner_position(corner), face_of_corner(corner));
    }
  }
  template <class Visit>
  void for_edges(std::size_t count, const Visit& visit) const {
    step_through(edge_until_, count, [&](std::size_t edge, double share, std::size_t) {
      const Index corner = edges_[edge];
      const Vec3 a = mesh_.corner_position(corner);
      visit(a + (mesh_.corner_position(next_corner(corner)) - a) * share, face_of_corner(corner));
    });
  }
  template <class Visit>
  void for_faces(std::size_t count, const Visit& visit) const {
    step_through(face_until_, count, [&](std::size_t face, double, std::size_t k) {
      visit(point_on_face(mesh_, static_cast<Index>(face), k), static_cast<Index>(face));
    });
  }

  std::size_t vertex_count() const { return vertices_.size(); }

 private:
  void find_vertices() {
    std::vector<bool> found(mesh_.vertex_count());
    for (Index corner = 0; corner < mesh_.corner_wedge.size(); ++corner) {
      const Index v = mesh_.corner_vertex(corner);
      if (!found[v]) vertices_.push_back(corner);
      found[v] = true;
    }
  }

  /// Returns the length of all edges, in which those whose faces are narrower than `least_width` count less.
  double find_edges(double least_width) {
    for (const Surface::EdgeFaces& edge : surface_.edges) {
      const Vec3 from = mesh_.corner_position(edge.corner);
      const double size = length(mesh_.corner_position(next_corner(edge.corner)) - from);
      const double narrow = edge.area < size * least_width ? edge.area / (size * least_width) : 1;
      edges_.push_back(edge.corner);
      edge_until_.push_back(size * narrow * narrow);
    }
    return add_up(edge_until_);
  }

  const Surface& surface_;
  const Mesh& mesh_;
  std::vector<Index> vertices_;     // A corner at each.
  std::vector<Index> edges_;        // The first corner on each.
  std::vector<double> edge_until_;  // Running sums of lengths, less where faces are narrow.
  std::vector<double> face_until_;  // Running sums of areas.
  Counts counts_;
};

/// Whether two meshes have the same vertices, by number, at their faces' corners: only where these lie may differ.
bool have_same_faces(const Mesh& a, const Mesh& b) {
  return a.vertex_count() == b.vertex_count() && a.corner_wedge == b.corner_wedge && a.wedge_vertex == b.wedge_vertex;
}

/// What is known where the faces are the same: no point is farther than the corners of its face have moved.
SurfaceBounds bounds_by_correspondence(const Mesh& from, const Mesh& to) {
  SurfaceBounds bounds(from, false);
  for (Index corner = 0; corner < from.corner_wedge.size(); ++corner) {
    const Index face = face_of_corner(corner);
    const double moved = length(from.corner_position(corner) - to.corner_position(corner));
    bounds.faces[face] = corner % 3 == 0 ? moved : std::max(bounds.faces[face], moved);
    bounds.vertices[from.corner_vertex(corner)] = {moved, face, false};
  }
  return bounds;
}

/// The distances at samples of one kind and, where `to_faces` is given, the normal angles.
class Tally {
 public:
  /// `near`: by vertex of `from`, a face of `to` near it, where one is known.
  Tally(const Surface& from, const Surface& to, std::span<const Index> near, CoincidentFaces* to_faces = nullptr)
      : from_(from), to_(to), near_(near), to_faces_(to_faces) {}

  void operator()(const Vec3& point, Index face) {
    points_.push_back(point);
    on_faces_.push_back(face);
  }

  /// Looks up the samples, those of neighbouring faces together, and adds up what is found; stops where the work is
  /// cancelled.
  void finish(ProgressSteps& steps) {
    const std::vector<Index> order = along_surface();
    const bool correspond = have_same_faces(from_.mesh, to_.mesh);
    std::vector<Vec3> points;
    std::vector<SurfaceIndex::Hit> hits;
    for (std::size_t first = 0; first < order.size(); first += points.size()) {
      points.clear();
      for (std::size_t i = first; i < std::min(first + kSamplesOfStep, order.size()); ++i)
        points.push_back(points_[order[i]]);
      hits.assign(points.size(), {0, {}, kNoIndex, 0});
      for (std::size_t i = 0; i < hits.size(); ++i) {
        const Index face = on_faces_[order[first + i]];
        hits[i].face = correspond ? face : hint_at(points[i], face);
      }
      to_.index.nearest(points, hits);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!steps.next()) return;
        add(hits[i], on_faces_[order[first + i]]);
      }
    }
  }

  std::size_t count() const { return points_.size(); }
  double mean() const { return over_count(sum_); }
  double mean_square() const { return over_count(squares_); }
  double mean_angle() const { return over_count(angles_); }

 private:
  void add(const SurfaceIndex::Hit& hit, Index face) {
    sum_ += hit.distance;
    squares_ += hit.distance * hit.distance;
    if (to_faces_ != nullptr) angles_ += least_angle(area_vector(from_.mesh, face), to_faces_->as_near_as(hit));
  }
  /// What is near the corner of a face that a point of it is nearest to.
  Index hint_at(const Vec3& point, Index face) const {
    Index best = kNoIndex;
    double least = detail::kUnbounded;
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const Index there = near_[from_.mesh.corner_vertex(corner)];
      const double squared = squared_length(point - from_.mesh.corner_position(corner));
      if (there != kNoIndex && squared < least) best = there, least = squared;
    }
    return best;
  }
  /// The samples by their faces, such that those of neighbours are near each other, and those of a face along a curve.
  std::vector<Index> along_surface() const {
    const std::span<const Index> ranks = from_.index.ranks();
    const detail::MortonCurve curve(from_.box);
    std::vector<std::pair<std::uint64_t, Index>> keys(count());
    for (Index i = 0; i < keys.size(); ++i)
      keys[i] = {std::uint64_t{ranks[on_faces_[i]]} << 32 | curve.code(points_[i]) >> 31, i};
    std::sort(keys.begin(), keys.end());
    std::vector<Index> order;
    for (const auto& [key, sample] : keys) order.push_back(sample);
    return order;
  }
  double least_angle(const Vec3& normal, std::span<const Index> faces) const {
    double least = std::numbers::pi;
    for (const Index face : faces) least = std::min(least, angle_between(normal, area_vector(to_.mesh, face)));
    return least;
  }
  double over_count(double x) const { return x / static_cast<double>(std::max<std::size_t>(count(), 1)); }

  const Surface& from_;
  const Surface& to_;
  std::span<const Index> near_;
  CoincidentFaces* to_faces_;
  std::vector<Vec3> points_;
  std::vector<Index> on_faces_;  // That they are on.
  double sum_ = 0, squares_ = 0, angles_ = 0;
};

/// Fills in mean and rms, and returns the mean angle between the normals at the faces' samples and at their nearest
/// points. `near` as in Tally.
double measure_means(const Surface& from, const Surface& to, std::span<const Index> near, std::size_t sample_count,
                     const Progress& progress, OneSidedDeviation& result) {
  const std::size_t face_count = std::max(from.mesh.face_count(), to.mesh.face_count());
  const double metros_count = std::max(kMetrosSamplesPerFace * static_cast<double>(face_count), kLeastSamples);
  const Samples samples(from, metros_count);
  const Samples::Counts& weights = samples.metros_counts();
  const auto taken = [&](double weight) {
    return static_cast<std::size_t>(std::ceil(static_cast<double>(sample_count) * weight / metros_count));
  };
  CoincidentFaces to_faces(to.mesh, to.index);
  Tally vertices(from, to, near), edges(from, to, near), faces(from, to, near, &to_faces);
  samples.for_vertices(std::min(samples.vertex_count(), taken(weights.vertices)), std::ref(vertices));
  samples.for_edges(taken(weights.edges), std::ref(edges));
  // The angle needs a fair number in faces, even where few or none of Metro's are.
  samples.for_faces(taken(std::max(weights.faces, kLeastFaceShare * metros_count)), std::ref(faces));
  ProgressSteps steps(progress, vertices.count() + edges.count() + faces.count(), kSamplesOfStep);
  progress.add(0);
  for (Tally* tally : {&vertices, &edges, &faces}) tally->finish(steps);

  const auto combine = [&](double vertex_mean, double edge_mean, double face_mean) {
    return (weights.vertices * vertex_mean + weights.edges * edge_mean + weights.faces * face_mean) /
           (weights.vertices + weights.edges + weights.faces);
  };
  result.mean = combine(vertices.mean(), edges.mean(), faces.mean());
  result.rms = std::sqrt(combine(vertices.mean_square(), edges.mean_square(), faces.mean_square()));
  result.sample_count = vertices.count() + edges.count() + faces.count();
  return faces.mean_angle();
}

// Vertices that are looked at before all others: a maximum near the true one from the start saves most bounds.
constexpr std::size_t kScouted = 1000;

double larger_diagonal(const Surface& a, const Surface& b) { return std::max(a.box.diagonal(), b.box.diagonal()); }

/// One direction's search for its maximum, with what it needs.
struct DirectedSearch {
  DirectedSearch(const Surface& from, const Surface& to)
      : bounds(have_same_faces(from.mesh, to.mesh) ? bounds_by_correspondence(from.mesh, to.mesh)
                                                   : SurfaceBounds(from.mesh, false)),
        to_surface(to.mesh, to.opposite, to.index),
        to_patch(to.mesh, to.opposite),
        search(from.mesh, to_surface, to_patch, bounds) {}

  /// By vertex: a face near it, where one is known.
  std::vector<Index> near_vertices() const {
    std::vector<Index> near;
    near.reserve(bounds.vertices.size());
    for (const detail::KnownDistance& known : bounds.vertices) near.push_back(known.face);
    return near;
  }

  SurfaceBounds bounds;
  TargetSurface to_surface;
  PatchBound to_patch;
  SupremumSearch search;
};

void take_maximum(const SupremumSearch& search, OneSidedDeviation& result) {
  const OneSidedDeviation narrowed = search.result();
  result.maximum = narrowed.maximum;
  result.maximum_bound = narrowed.maximum_bound;
}

/// Narrows the maximum of each direction by itself, or of both together; leaves mean and rms as they are.
/// Returns what was found near the vertices of each on the other.
std::array<std::vector<Index>, 2> narrow_maxima(const Surface& a, const Surface& b, const DeviationOptions& options,
                                                Deviation& result) {
  DirectedSearch forward(a, b), backward(b, a);
  const Goal goal = detail::goal_of(options, larger_diagonal(a, b), 0);
  Goal forward_goal = goal, backward_goal = goal;
  forward.search.scout(kScouted, forward_goal);
  backward.search.scout(kScouted, backward_goal);
  if (options.each_way) {
    forward.search.narrow(forward_goal, options.budget);
    backward.search.narrow(backward_goal, options.budget);
  } else {
    forward_goal.found = std::max(forward_goal.found, backward_goal.found);
    detail::narrow_both(forward.search, backward.search, forward_goal, options.budget);
  }
  take_maximum(forward.search, result.forward);
  take_maximum(backward.search, result.backward);
  return {forward.near_vertices(), backward.near_vertices()};
}

/// The deviation where a mesh has no faces: the means are as the maximum.
Deviation deviation_of_empty(const Mesh& a, const Mesh& b) {
  Deviation result = detail::maximum_of_empty(a, b);
  result.forward.mean = result.forward.rms = result.forward.maximum;
  result.backward.mean = result.backward.rms = result.backward.maximum;
  return result;
}

/// What is known where nothing was looked at.
Deviation unmeasured() {
  Deviation result;
  result.forward.maximum_bound = result.backward.maximum_bound = detail::kUnbounded;
  return result;
}

}  // namespace

Vec3 point_on_face(const Mesh& mesh, Index face, std::size_t k) {
  return detail::point_on_triangle(mesh.corner_position(3 * face), mesh.corner_position(3 * face + 1),
                                   mesh.corner_position(3 * face + 2), k);
}

MeasuredSurface::MeasuredSurface(const Mesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
MeasuredSurface::~MeasuredSurface() = default;
MeasuredSurface::MeasuredSurface(MeasuredSurface&&) noexcept = default;
MeasuredSurface& MeasuredSurface::operator=(MeasuredSurface&&) noexcept = default;

const Mesh& MeasuredSurface::mesh() const { return impl_->mesh; }
const SurfaceIndex& MeasuredSurface::index() const { return impl_->index; }

Deviation measure_deviation(const MeasuredSurface& first, const MeasuredSurface& second,
                            const DeviationOptions& options) {
  const Surface &a = first.impl(), &b = second.impl();
  if (a.mesh.face_count() == 0 || b.mesh.face_count() == 0) return deviation_of_empty(a.mesh, b.mesh);
  Deviation result;
  // The maxima come first: what they find near the vertices is where the samples around them are looked for.
  const auto [near_a, near_b] = narrow_maxima(a, b, options, result);
  if (!options.progress.add(0)) return unmeasured();
  const auto means = [&] { return options.progress.part(kMeansShare); };
  result.mean_normal_angle = measure_means(a, b, near_a, options.sample_count, means(), result.forward);
  if (!options.progress.add(0)) return unmeasured();
  measure_means(b, a, near_b, options.sample_count, means(), result.backward);
  options.progress.reach(1);
  return result;
}

Deviation measure_deviation(const Mesh& a, const Mesh& b, const DeviationOptions& options) {
  const MeasuredSurface first(a);
  if (!options.progress.add(0)) return unmeasured();
  const MeasuredSurface second(b);
  if (!options.progress.add(0)) return unmeasured();
  return measure_deviation(first, second, options);
}

Deviation measure_maximum(const MeasuredSurface& first, const MeasuredSurface& second, const DeviationOptions& options,
                          double enough) {
  const Surface &a = first.impl(), &b = second.impl();
  if (a.mesh.face_count() == 0 || b.mesh.face_count() == 0) return detail::maximum_of_empty(a.mesh, b.mesh);
  DirectedSearch forward(a, b), backward(b, a);
  return detail::narrow_both(forward.search, backward.search, detail::goal_of(options, larger_diagonal(a, b), enough),
                             options.budget);
}

}  // namespace lodestone

// Alternates between looking for each sample's nearest face and moving the vertices, after Hoppe, DeRose, Duchamp,
// McDonald, Stuetzle: Mesh optimization (SIGGRAPH 1993). Lines are fitted to lines, so that borders and features slide
// along themselves. What would turn a face over, against what it was or against the original, stays where it was, and
// so does what would take one farther from the original than any was at first: the samples do not see a face that
// leaves the surface.

#include <lodestone/lod/placement.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <lodestone/core/detail/position_index.h>
#include <lodestone/lod/surface_index.h>

#include "distance/triangle.h"
#include "distance/triple_table.h"
#include "fit/attribute_lookup.h"
#include "fit/constrained_edges.h"
#include "fit/edge_turns.h"
#include "fit/face_guard.h"
#include "fit/fit_samples.h"
#include "fit/sparse_system.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr int kSolverSteps = 60;
constexpr double kStay = 0.02;                // how much a vertex wants to stay, of the weight of its samples
constexpr double kCornerStay = 1e6;           // the same where lines end or meet
constexpr double kAlong = 0.05;               // what distance along the surface or line counts, of distance from it
constexpr double kLineWeight = 2;             // of lines against surfaces, at equal length
constexpr double kRoam = 1.25;                // how far out of the original's box, of the rms distance around a vertex
constexpr std::size_t kFewSamples = 100'000;  // small levels take a few more iterations in no time

// Many faces of a level that keeps so large a share of them are the original's own. Sums of distances leave them where
// they are, sums of squares do not; what is nearer than a share of the rms distance counts by its square there, too.
constexpr double kFineShare = 0.3;
constexpr double kSoftening = 0.1;

// How many iterations a level is worth. Edges are turned in the first ones, and the vertices follow.
struct Effort {
  int times;       // as many as asked for, at most
  int turning;     // of them with edges turned
  double settled;  // of the sum before: less gain than this is not worth another
};
constexpr Effort kEffort = {1, 3, 0.985};
constexpr Effort kEffortForFew = {6, 12, 0.999};

// At so many points of the original, spread over its faces, a fit is compared with what was there before; at least and
// at most so many of each face.
constexpr std::size_t kCheckedPoints = 20'000;
constexpr std::size_t kFewestOfFace = 3;
constexpr std::size_t kMostOfFace = 12;

/// Which of a level's vertices lie where fixed ones of the original do.
std::vector<std::uint8_t> find_fixed(const Mesh& original, const Mesh& level,
                                     const std::vector<std::uint8_t>& fixed_of_original) {
  assert(fixed_of_original.empty() || fixed_of_original.size() == original.vertex_count());
  PositionIndex places(original.positions);
  for (Index v = 0; v < fixed_of_original.size(); ++v)
    if (fixed_of_original[v] != 0) places.add(v);
  std::vector<std::uint8_t> fixed;
  for (const Vec3f& p : level.positions) fixed.push_back(places.find(p) != kNoIndex ? 1 : 0);
  return fixed;
}

/// Leaves out faces that lie on another one, whichever way they face: what is nearest then has one direction.
Mesh without_layers(const Mesh& mesh) {
  const std::vector<Index> places = places_of(mesh.positions);
  TripleTable seen(mesh.face_count());
  std::vector<Index> kept;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    Triple corners;
    for (Index k = 0; k < 3; ++k) corners[k] = places[mesh.corner_vertex(3 * f + k)];
    std::sort(corners.begin(), corners.end());
    if (seen.insert(corners, f) == f) kept.push_back(f);
  }
  return pick_faces(mesh, kept);
}

bool has_layers(const std::vector<MeshEdge>& edges) {
  return std::any_of(edges.begin(), edges.end(), [](const MeshEdge& edge) { return !edge.layers.empty(); });
}

class Fitting {
 public:
  Fitting(const Mesh& original, Mesh& level, const PlacementOptions& options)
      : original_(original),
        level_(level),
        options_(options),
        is_fine_(static_cast<double>(level.face_count()) >= kFineShare * static_cast<double>(original.face_count())),
        edges_(list_edges(level)),
        skin_(has_layers(edges_) ? without_layers(original) : Mesh{}),
        guard_(has_layers(edges_) ? skin_ : original),
        fixed_(find_fixed(original, level, options.fixed)),
        box_(bounding_box(original)),
        samples_(original, options.samples_per_face * level.face_count()),
        lines_(original) {
    classify();
  }

  void run();

 private:
  void classify();
  void assign();
  void fence();
  void choose_norm();
  double error() const;
  void turn_edges();
  void assemble(SparseSystem& system) const;
  void add_lines(SparseSystem& system) const;
  void move();
  double forward_error() const;
  void keep_in_box(std::vector<Vec3>& positions) const;

  const Mesh& original_;
  Mesh& level_;
  const PlacementOptions& options_;
  bool is_fine_;
  std::vector<MeshEdge> edges_;
  Mesh skin_;  // the original as the guard sees it, where sheets lie on one another
  OriginalGuard guard_;
  std::vector<std::uint8_t> fixed_;  // by vertex
  Box box_;                          // of the original
  std::vector<double> roam_;         // by vertex: how far it may leave the box
  SampleNorm norm_;
  SurfaceSamples samples_;
  LineSamples lines_;
  std::vector<Index> corner_vertex_;
  std::vector<std::uint8_t> line_ends_;  // by vertex: constrained edges, at most 255
};

void Fitting::classify() {
  line_ends_.assign(level_.vertex_count(), 0);
  for (const MeshEdge& edge : edges_)
    for (const Index v : edge.vertices)
      if (edge.constrained && line_ends_[v] < 255) ++line_ends_[v];
}

/// Finds the face nearest to each sample.
void Fitting::assign() {
  const SurfaceIndex surface(level_);
  Index last = kNoIndex;  // Samples that follow each other are mostly neighbours.
  for (SurfaceSample& sample : samples_.all()) {
    const Index hint = sample.face != kNoIndex ? sample.face : last;
    last = surface.nearest(sample.position, std::numeric_limits<double>::infinity(), hint).face;
    sample.place_on(level_, last);
  }
}

/// Lets each vertex leave the original's box about as far as the surface around it is off: on a curved surface it
/// stands out by what its faces lie within, while a face that stands for far more than itself would reach for all of
/// that.
void Fitting::fence() {
  std::vector<double> weight(level_.vertex_count(), 0);
  roam_.assign(level_.vertex_count(), 0);
  for (const SurfaceSample& sample : samples_.all())
    for (Index k = 0; k < 3; ++k) {
      const Index v = level_.corner_vertex(3 * sample.face + k);
      weight[v] += sample.weight;
      roam_[v] += sample.weight * sample.squared_distance;
    }
  for (Index v = 0; v < roam_.size(); ++v) roam_[v] = weight[v] > 0 ? kRoam * std::sqrt(roam_[v] / weight[v]) : 0;
}

void Fitting::keep_in_box(std::vector<Vec3>& positions) const {
  for (Index v = 0; v < positions.size(); ++v) {
    const Vec3 roam(roam_[v], roam_[v], roam_[v]), low = box_.low - roam, high = box_.high + roam;
    Vec3& p = positions[v];
    p = {std::clamp(p.x, low.x, high.x), std::clamp(p.y, low.y, high.y), std::clamp(p.z, low.z, high.z)};
  }
}

/// Chooses sums of distances for fine levels.
void Fitting::choose_norm() {
  if (!is_fine_) return;
  double area = 0;
  for (const SurfaceSample& sample : samples_.all()) area += sample.weight;
  if (area > 0) norm_.softening = kSoftening * std::sqrt(error() / area);
}

/// The sum that is minimised, over the samples as last assigned.
double Fitting::error() const {
  double sum = 0;
  for (const SurfaceSample& sample : samples_.all()) sum += sample.weight * norm_.error(sample.squared_distance);
  return sum;
}

void Fitting::turn_edges() {
  if (detail::turn_edges(level_, edges_, samples_.all(), norm_, guard_, fixed_) > 0) edges_ = list_edges(level_);
}

void Fitting::assemble(SparseSystem& system) const {
  system.clear();
  for (const SurfaceSample& sample : samples_.all()) {
    const Vec3 normal = normalized(area_vector(level_, sample.face));
    const double weight = sample.weight * norm_.weight(sample.squared_distance);
    const Symmetric3 metric = Symmetric3::identity(kAlong * weight) + Symmetric3::outer(normal, (1 - kAlong) * weight);
    system.add(&corner_vertex_[3 * std::size_t{sample.face}], sample.weights.data(), 3, sample.position, metric);
  }
  add_lines(system);
  const double one = 1;
  for (Index v = 0; v < level_.vertex_count(); ++v) {
    const bool stays = fixed_[v] != 0 || (line_ends_[v] != 0 && line_ends_[v] != 2);
    const double weight = (stays ? kCornerStay : kStay) * system.stiffness(v);
    system.add(&v, &one, 1, Vec3(level_.positions[v]), Symmetric3::identity(weight > 0 ? weight : 1));
  }
}

/// Draws the level's lines to the original's. A sample of length l stands for an area of l times the edge it lies on.
void Fitting::add_lines(SparseSystem& system) const {
  Mesh segments;
  segments.positions = level_.positions;
  std::vector<const MeshEdge*> of_face;
  for (const MeshEdge& edge : edges_) {
    if (!edge.constrained) continue;
    of_face.push_back(&edge);
    for (const Index v : {edge.vertices[0], edge.vertices[1], edge.vertices[1]}) segments.corner_wedge.push_back(v);
  }
  if (of_face.empty()) return;
  segments.wedge_vertex.resize(segments.positions.size());
  for (Index v = 0; v < segments.wedge_vertex.size(); ++v) segments.wedge_vertex[v] = v;
  const SurfaceIndex index(segments);
  for (const LineSample& sample : lines_.all()) {
    const SurfaceIndex::Hit hit = index.nearest(sample.position, std::numeric_limits<double>::infinity());
    const MeshEdge& edge = *of_face[hit.face];
    const Vec3 a(level_.positions[edge.vertices[0]]);
    const Vec3 b(level_.positions[edge.vertices[1]]);
    const double length_of_edge = length(b - a);
    if (!(length_of_edge > 0)) continue;
    const double t = std::clamp(dot(hit.point - a, b - a) / (length_of_edge * length_of_edge), 0.0, 1.0);
    const double weights[2] = {1 - t, t};
    const double weight = kLineWeight * sample.length * length_of_edge * norm_.weight(hit.distance * hit.distance);
    const Symmetric3 metric =
        Symmetric3::identity(weight) + Symmetric3::outer((b - a) * (1 / length_of_edge), -(1 - kAlong) * weight);
    system.add(edge.vertices.data(), weights, 2, sample.position, metric);
  }
}

void Fitting::move() {
  corner_vertex_.resize(level_.corner_wedge.size());
  for (Index c = 0; c < corner_vertex_.size(); ++c) corner_vertex_[c] = level_.corner_vertex(c);
  SparseSystem system(level_.vertex_count(), corner_vertex_);
  assemble(system);
  std::vector<Vec3> moved;
  for (const Vec3f& p : level_.positions) moved.emplace_back(p);
  system.solve(moved, kSolverSteps);
  keep_in_box(moved);
  std::vector<Vec3f> positions;
  for (const Vec3& p : moved)
    positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  for (Index v = 0; v < positions.size(); ++v)
    if (fixed_[v] != 0) positions[v] = level_.positions[v];
  do {
    keep_faces_upright(level_, positions);
  } while (!guard_.keep_faces_near(level_, positions));
  level_.positions = std::move(positions);
}

/// The sum again, over points inside the original's faces that the fit does not go by: these stand for their areas even
/// where large faces meet small ones at an angle.
double Fitting::forward_error() const {
  const SurfaceIndex surface(level_);
  const std::size_t count = std::clamp(kCheckedPoints / original_.face_count(), kFewestOfFace, kMostOfFace);
  double sum = 0;
  Index near = kNoIndex;
  for (Index f = 0; f < original_.face_count(); ++f) {
    const double share = 0.5 * length(area_vector(original_, f)) / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 point = point_on_triangle(original_.corner_position(3 * f), original_.corner_position(3 * f + 1),
                                           original_.corner_position(3 * f + 2), k + 1);
      const SurfaceIndex::Hit hit = surface.nearest(point, std::numeric_limits<double>::infinity(), near);
      near = hit.face;
      sum += share * norm_.error(hit.distance * hit.distance);
    }
  }
  return sum;
}

void Fitting::run() {
  assign();
  choose_norm();
  fence();
  const OriginalGuard::Survey survey = guard_.survey(level_, norm_);
  double reach = survey.farthest;
  for (const SurfaceSample& sample : samples_.all()) reach = std::max(reach, std::sqrt(sample.squared_distance));
  guard_.set_reach(reach);
  const Mesh unfitted = level_;
  const double error_of_unfitted = is_fine_ ? forward_error() + survey.error : 0;
  double best = error();
  Mesh best_level = level_;
  const Effort effort = samples_.all().size() <= kFewSamples ? kEffortForFew : kEffort;
  for (int i = 0; i < effort.times * options_.iterations; ++i) {
    if (i < effort.turning) turn_edges();
    move();
    assign();
    const double now = error();
    if (!(now < best)) break;
    const bool settled = now > effort.settled * best;
    best = now;
    best_level = level_;
    if (settled && i + 1 >= effort.turning) break;
  }
  level_ = std::move(best_level);
  // Where most faces have no error yet there is little to gain, and the samples may mislead.
  if (is_fine_ && forward_error() + guard_.survey(level_, norm_).error > error_of_unfitted) level_ = unfitted;
}

/// Leaves out vertices and wedges that no face uses.
Mesh compacted(const Mesh& mesh) {
  std::vector<Index> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), Index{0});
  return pick_faces(mesh, faces);
}

}  // namespace

Mesh optimise_placement(const Mesh& original, const Mesh& level, const PlacementOptions& options) {
  Mesh fitted = compacted(level);
  if (fitted.face_count() == 0 || original.face_count() == 0) return fitted;
  const Mesh before = fitted;
  Fitting(original, fitted, options).run();
  look_up_attributes(original, before, fitted);
  return fitted;
}

}  // namespace lodestone

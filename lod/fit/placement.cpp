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
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/detail/grouping.h>
#include <lodestone/core/detail/position_index.h>
#include <lodestone/lod/surface_index.h>

#include "distance/face_boxes.h"
#include "distance/face_names.h"
#include "distance/face_order.h"
#include "distance/point_triangle.h"
#include "distance/surface_walk.h"
#include "distance/triangle.h"
#include "fit/attribute_lookup.h"
#include "fit/common_vertices.h"
#include "fit/constrained_edges.h"
#include "fit/edge_turns.h"
#include "fit/face_guard.h"
#include "fit/fit_samples.h"
#include "fit/sparse_system.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr int kSolverSteps = 60;
constexpr double kStay = 0.02;       // how much a vertex wants to stay, of the weight of its samples
constexpr double kCornerStay = 1e6;  // the same where lines end or meet
constexpr double kAlong = 0.05;      // what distance along the surface or line counts, of distance from it
constexpr double kLineWeight = 2;    // of lines against surfaces, at equal length
constexpr double kStayAside = 10;    // what a full mesh's vertex wants to stay aside of its normal, where that counts
constexpr double kRoam = 1.25;       // how far out of the original's box, of the rms distance around a vertex

// Many faces of a level that keeps so large a share of them are the original's own. Sums of distances leave them where
// they are, sums of squares do not; what is nearer than a share of the rms distance counts by its square there, too.
constexpr double kFineShare = 0.3;
constexpr double kSoftening = 0.1;

// Vertices that go farther than their optimum for the places the samples have now come sooner to where these go on to.
// The first step is to the optimum; so are all after one that made things worse.
constexpr double kOverRelaxation = 1.7;

constexpr double kFarAtFirst = 1;  // of the mean distance: from there on a sample may be on the near side of a fold

constexpr std::size_t kSamplesOfStep = 1024;  // looked up together, between two words about the progress
constexpr double kFirstShare = 0.2;           // of the work: to find where each sample belongs

// What a level is worth, by effort. Many faces of a fine level are the original's own: fitting it costs most and gains
// least, so that the least efforts leave it out. Edges are turned in the first iterations, and the vertices follow.
// Large levels settle sooner, and each iteration of theirs costs more: where there are more than so many samples there
// are fewer.
struct Effort {
  int moves;                     // of all vertices, at most
  int turning;                   // of them with edges turned
  double settled;                // of the sum before: less gain than this is not worth another
  std::size_t samples_per_face;  // of the level, at most: where the original has more, some are left out
  int search_every;              // so many iterations, in place of following samples; 0: never again
  double finest = 1;             // of the original's faces: a level of more than this share stays as it is
};
constexpr std::array<Effort, kMostEffort> kEfforts = {{{1, 1, 0.9, 4, 0, 0.2},
                                                       {2, 1, 0.9, 10, 0, 0.3},
                                                       {4, 3, 0.97, 15, 0},
                                                       {8, 5, 0.98, 20, 5},
                                                       {24, 6, 0.99, 30, 5},
                                                       {48, 12, 0.998, 30, 5},
                                                       {48, 12, 0.999, 60, 4},
                                                       {48, 12, 0.999, 60, 3},
                                                       {72, 12, 0.9995, 60, 3}}};
constexpr std::size_t kFewSamples = 100'000;
constexpr int kFewerMoves = 3;
constexpr int kFewerTurning = 3;
constexpr double kSettledSooner = 3;

Effort effort_for(int wanted, std::size_t sample_count) {
  Effort effort = kEfforts[static_cast<std::size_t>(std::clamp(wanted, kLeastEffort, kMostEffort) - kLeastEffort)];
  if (sample_count <= kFewSamples) return effort;
  effort.moves = std::max(effort.moves / kFewerMoves, 1);
  effort.turning = std::max(effort.turning / kFewerTurning, 1);
  effort.settled = 1 - kSettledSooner * (1 - effort.settled);
  return effort;
}

/// Whether fitting a level is worth it.
bool is_worth_fitting(const Mesh& level, const Mesh& original, int effort) {
  return static_cast<double>(level.face_count()) <=
         effort_for(effort, 0).finest * static_cast<double>(original.face_count());
}

// At so many points of the original, spread over its faces, a fit is compared with what was there before: so many of
// each face at most, and at least of those that are looked at.
constexpr std::size_t kCheckedPoints = 50'000;
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
  FaceNames seen(mesh.vertex_count(), mesh.face_count());
  std::vector<Index> kept;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    FaceName corners;
    for (Index k = 0; k < 3; ++k) corners[k] = places[mesh.corner_vertex(3 * f + k)];
    std::sort(corners.begin(), corners.end());
    if (seen.insert(corners, f) == f) kept.push_back(f);
  }
  return pick_faces(mesh, kept);
}

bool has_layers(const std::vector<MeshEdge>& edges) {
  return std::any_of(edges.begin(), edges.end(), [](const MeshEdge& edge) { return !edge.layers.empty(); });
}

/// A mesh's faces, such that those that follow each other lie together.
std::vector<Index> faces_in_order(const Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.face_count());
  for (Index f = 0; f < triangles.size(); ++f) triangles[f] = triangle_of(mesh, f);
  return compact_order(triangles);
}

/// The original, and what all fits to it need.
struct Original {
  Original(const Mesh& given, const Progress& progress);

  /// False where the work was cancelled before all was made.
  bool is_ready() const { return skin_walk.has_value(); }

  const Mesh& mesh;
  Box box;
  std::vector<Index> face_order;
  std::optional<LineSamples> lines;
  std::optional<Mesh> layers;
  const Mesh* skin;  // as the guard sees it, where sheets lie on one another
  std::optional<FaceBoxes> skin_boxes;
  std::optional<SurfaceWalk> skin_walk;
};

Original::Original(const Mesh& given, const Progress& progress)
    : mesh(given), box(bounding_box(given)), face_order(faces_in_order(given)), skin(&given) {
  if (!progress.add(0)) return;
  const std::vector<MeshEdge> edges = list_edges(given);
  lines.emplace(given, edges);
  if (has_layers(edges)) skin = &layers.emplace(without_layers(given));
  if (!progress.add(0)) return;
  skin_boxes.emplace(*skin);
  if (!progress.add(0)) return;
  skin_walk.emplace(*skin);
}

/// What a fit may change: everything, or how high vertices lie above where they were, and a little aside.
enum class Freedom { All, Heights };

class Fitting {
 public:
  Fitting(const Original& original, Mesh& level, const PlacementOptions& options, Freedom freedom)
      : original_(original),
        level_(level),
        is_fine_(static_cast<double>(level.face_count()) >=
                 kFineShare * static_cast<double>(original.mesh.face_count())),
        progress_(options.progress),
        steps_(progress_.part(0), 0, kSamplesOfStep),
        edges_(list_edges(level)),
        guard_(*original.skin_boxes, *original.skin_walk, steps_),
        fixed_(find_fixed(original.mesh, level, options.fixed)),
        freedom_(freedom),
        samples_(original.mesh, original.face_order,
                 effort_for(options.effort, 0).samples_per_face * level.face_count()),
        effort_(effort_for(options.effort, samples_.all().size())),
        near_line_(original.lines->all().size(), kNoIndex) {
    classify();
    if (freedom_ == Freedom::Heights) note_places();
  }

  void run();
  double mean_square() const;  ///< of the samples' distances

 private:
  using LineEnds = std::array<Index, 2>;  // vertices of the level

  /// Hears whether the fit is still wanted.
  bool goes_on() const { return progress_.add(0); }
  void classify();
  void note_places();
  void start();
  void start_from_common_vertices();
  void search(double squared_distance);
  void update_walk();
  void follow();
  void fence();
  void choose_norm();
  double error() const;
  double mean_distance() const;
  template <class Value>
  double mean(const Value& value) const;
  void turn_edges(bool is_first);
  void list_edges_anew();
  void assemble(SparseSystem& system);
  void add_faces(SparseSystem& system) const;
  void search_lines(std::span<const LineEnds> lines);
  void follow_lines(std::span<const LineEnds> lines);
  void add_lines(SparseSystem& system);
  void move(double relaxation);
  double forward_error();
  std::vector<Index> faces_of_samples() const;
  void keep_in_box(std::vector<Vec3>& positions) const;

  const Original& original_;
  Mesh& level_;
  bool is_fine_;
  Progress progress_;
  ProgressSteps steps_;  // points and faces looked at
  std::vector<MeshEdge> edges_;
  std::optional<SurfaceWalk> walk_;     // of the faces as they are now
  std::optional<SparseSystem> system_;  // the same
  OriginalGuard guard_;
  std::vector<std::uint8_t> fixed_;  // by vertex
  Freedom freedom_;
  // Where heights are free above all: by vertex, as the level was given.
  std::vector<Vec3> places_, normals_;
  double stay_aside_ = 0;     // how much a vertex wants to stay aside of its normal, of the weight of its samples
  std::vector<double> roam_;  // by vertex: how far it may leave the box
  SampleNorm norm_;
  SurfaceSamples samples_;
  Effort effort_;
  std::vector<Index> near_line_;         // by sample of a line: the level's line that it was last nearest to
  bool are_lines_found_ = false;         // else they are to be searched for
  std::vector<std::uint8_t> line_ends_;  // by vertex: constrained edges, at most 255
};

void Fitting::classify() {
  line_ends_.assign(level_.vertex_count(), 0);
  for (const MeshEdge& edge : edges_)
    for (const Index v : edge.vertices)
      if (edge.constrained && line_ends_[v] < 255) ++line_ends_[v];
}

void Fitting::note_places() {
  stay_aside_ =
      kStayAside * static_cast<double>(level_.face_count()) / static_cast<double>(original_.mesh.face_count());
  normals_.resize(level_.vertex_count());
  for (Index f = 0; f < level_.face_count(); ++f)
    for (Index c = 3 * f; c < 3 * f + 3; ++c) normals_[level_.corner_vertex(c)] += area_vector(level_, f);
  for (Vec3& normal : normals_) normal = normalized(normal);
  for (const Vec3f& p : level_.positions) places_.emplace_back(p);
}

/// Says where on the level samples are near, and where on the original the level's faces are.
void Fitting::start_from_common_vertices() {
  const CommonVertices vertices(original_.mesh);
  const std::vector<Index> near = vertices.faces_near(level_);
  for (SurfaceSample& sample : samples_.all()) sample.face = near[sample.vertex];
  const bool is_whole = original_.skin == &original_.mesh;
  guard_.start_from(is_whole ? vertices.faces_at(level_) : CommonVertices(*original_.skin).faces_at(level_));
}

/// Finds where samples belong at first: from the vertices that level and original share each goes over the surface, and
/// is searched for where that leads it farther away than most, since it may have ended on the near side of a fold.
void Fitting::start() {
  start_from_common_vertices();
  follow();
  const double far = kFarAtFirst * mean_distance();
  search(far * far);
}

/// Finds the face nearest to each sample that is no nearer than that to where it belongs now, wherever that face is.
void Fitting::search(double squared_distance) {
  if (!goes_on()) return;
  const SurfaceIndex surface(level_);
  std::vector<SurfaceSample*> samples;
  for (SurfaceSample& sample : samples_.all())
    if (sample.face == kNoIndex || sample.squared_distance >= squared_distance) samples.push_back(&sample);
  std::vector<Vec3> points;
  std::vector<SurfaceIndex::Hit> hits;
  for (std::size_t first = 0; first < samples.size(); first += kSamplesOfStep) {
    const auto together = std::span(samples).subspan(first, std::min(samples.size() - first, kSamplesOfStep));
    points.clear();
    hits.clear();
    for (const SurfaceSample* sample : together) {
      points.push_back(sample->position);
      hits.push_back({0, {}, sample->face, 0});
    }
    surface.nearest(points, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!steps_.next()) return;
      const auto& [distance, point, face, visits] = hits[i];
      together[i]->place_at(face, weights_at(point, triangle_of(level_, face), distance * distance));
    }
  }
  are_lines_found_ = false;
}

void Fitting::update_walk() {
  if (walk_)
    walk_->update(level_);
  else
    walk_.emplace(level_);
}

/// Follows the samples over the surface to where it is nearest to them now.
void Fitting::follow() {
  if (!goes_on()) return;
  update_walk();
  for (SurfaceSample& sample : samples_.all()) {
    if (!steps_.next()) return;
    if (sample.face == kNoIndex) continue;
    const SurfaceWalk::Place place = walk_->nearest_from(sample.position, sample.face);
    sample.place_at(place.face, place.on);
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
    const Vec3 roam(roam_[v], roam_[v], roam_[v]), low = original_.box.low - roam, high = original_.box.high + roam;
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

double Fitting::mean_distance() const {
  return mean([](const SurfaceSample& sample) { return std::sqrt(sample.squared_distance); });
}

double Fitting::mean_square() const {
  return mean([](const SurfaceSample& sample) { return sample.squared_distance; });
}

template <class Value>
double Fitting::mean(const Value& value) const {
  double area = 0, sum = 0;
  for (const SurfaceSample& sample : samples_.all()) {
    area += sample.weight;
    sum += sample.weight * value(sample);
  }
  return area > 0 ? sum / area : 0;
}

/// Before vertices have moved, what an edge would do says little of what it will.
void Fitting::turn_edges(bool is_first) {
  const bool any = detail::turn_edges(level_, edges_, samples_.all(), norm_, guard_, fixed_) != 0;
  if (is_first)
    for (MeshEdge& edge : edges_) edge.stays = false;
  if (!any) return;
  walk_.reset();
  system_.reset();
  if (goes_on()) list_edges_anew();
}

/// Lists edges after some were turned; those that were there before keep what is known of them.
void Fitting::list_edges_anew() {
  const std::vector<MeshEdge> before = std::exchange(edges_, list_edges(level_));
  auto old = before.begin();
  for (MeshEdge& edge : edges_) {
    while (old != before.end() && old->vertices < edge.vertices) ++old;
    edge.stays = old != before.end() && old->vertices == edge.vertices && old->stays;
  }
}

void Fitting::assemble(SparseSystem& system) {
  system.clear();
  add_faces(system);
  add_lines(system);
  const double one = 1;
  for (Index v = 0; v < level_.vertex_count(); ++v) {
    const bool stays = fixed_[v] != 0 || (line_ends_[v] != 0 && line_ends_[v] != 2);
    const double weight = (stays ? kCornerStay : kStay) * system.stiffness(v);
    system.add(&v, &one, 1, Vec3(level_.positions[v]), Symmetric3::identity(weight > 0 ? weight : 1));
    if (freedom_ == Freedom::All || !(system.stiffness(v) > 0)) continue;
    const double aside = stay_aside_ * system.stiffness(v);
    system.add(&v, &one, 1, places_[v], Symmetric3::identity(aside) + Symmetric3::outer(normals_[v], -aside));
  }
}

/// Draws faces to the samples that are nearest to them. All samples of a face look along its one normal.
void Fitting::add_faces(SparseSystem& system) const {
  struct Sums {
    std::array<double, 6> products{};
    std::array<Vec3, 3> pulls{};
  };
  std::vector<Sums> sums(level_.face_count());
  for (const SurfaceSample& sample : samples_.all()) {
    Sums& sum = sums[sample.face];
    const double weight = sample.weight * norm_.weight(sample.squared_distance);
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = weight * sample.weights[k];
      sum.products[k] += share * sample.weights[k];
      sum.products[3 + k] += share * sample.weights[(k + 1) % 3];
      sum.pulls[k] += sample.position * share;
    }
  }
  for (Index f = 0; f < sums.size(); ++f) {
    const Vec3 normal = normalized(area_vector(level_, f));
    system.add_face(f, sums[f].products, sums[f].pulls,
                    Symmetric3::identity(kAlong) + Symmetric3::outer(normal, 1 - kAlong));
  }
}

/// Searches for the level's line nearest to each sample of a line, wherever that is.
void Fitting::search_lines(std::span<const LineEnds> lines) {
  Mesh segments;  // as triangles without area
  segments.positions = level_.positions;
  for (const LineEnds& ends : lines)
    for (const Index v : {ends[0], ends[1], ends[1]}) segments.corner_wedge.push_back(v);
  segments.wedge_vertex.resize(segments.positions.size());
  std::iota(segments.wedge_vertex.begin(), segments.wedge_vertex.end(), Index{0});
  const SurfaceIndex index(segments);
  const std::vector<LineSample>& samples = original_.lines->all();
  for (std::size_t i = 0; i < samples.size() && steps_.next(); ++i) {
    const Index hint = near_line_[i] < lines.size() ? near_line_[i] : kNoIndex;
    near_line_[i] = index.nearest(samples[i].position, kUnlimited, hint).face;
  }
  are_lines_found_ = true;
}

/// Goes on from where each sample of a line was, from line to line, for as long as the next one is nearer.
void Fitting::follow_lines(std::span<const LineEnds> lines) {
  const Grouping lines_at(level_.vertex_count(), 2 * lines.size(), [&](Index end) { return lines[end / 2][end % 2]; });
  const auto squared_distance = [&](const Vec3& p, Index line) {
    const auto [a, b] = lines[line];
    return squared_distance_to_segment(p, Vec3(level_.positions[a]), Vec3(level_.positions[b]));
  };
  const std::vector<LineSample>& samples = original_.lines->all();
  for (std::size_t i = 0; i < samples.size() && steps_.next(); ++i) {
    Index& line = near_line_[i];
    double least = squared_distance(samples[i].position, line);
    for (Index before = kNoIndex; line != before;) {
      before = line;
      for (const Index v : lines[before])
        for (const Index end : lines_at[v])
          if (const double there = squared_distance(samples[i].position, end / 2); there < least)
            least = there, line = end / 2;
    }
  }
}

/// Draws the level's lines to the original's. A sample of length l stands for an area of l times the edge it lies on.
void Fitting::add_lines(SparseSystem& system) {
  std::vector<LineEnds> lines;
  for (const MeshEdge& edge : edges_)
    if (edge.constrained) lines.push_back(edge.vertices);
  if (lines.empty()) return;
  are_lines_found_ ? follow_lines(lines) : search_lines(lines);
  if (!goes_on()) return;
  const std::vector<LineSample>& samples = original_.lines->all();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const LineSample& sample = samples[i];
    const LineEnds& ends = lines[near_line_[i]];
    const Vec3 a(level_.positions[ends[0]]), b(level_.positions[ends[1]]);
    const double length_of_edge = length(b - a);
    if (!(length_of_edge > 0)) continue;
    const double t = std::clamp(dot(sample.position - a, b - a) / (length_of_edge * length_of_edge), 0.0, 1.0);
    const double squared = squared_length(sample.position - (a + (b - a) * t));
    const double weights[2] = {1 - t, t};
    const double weight = kLineWeight * sample.length * length_of_edge * norm_.weight(squared);
    const Symmetric3 metric =
        Symmetric3::identity(weight) + Symmetric3::outer((b - a) * (1 / length_of_edge), -(1 - kAlong) * weight);
    system.add(ends.data(), weights, 2, sample.position, metric);
  }
}

/// `relaxation`: how far vertices go, of the way to their optimum.
void Fitting::move(double relaxation) {
  if (!goes_on()) return;
  if (!system_) system_.emplace(level_);
  assemble(*system_);
  if (!goes_on()) return;
  std::vector<Vec3> moved;
  for (const Vec3f& p : level_.positions) moved.emplace_back(p);
  system_->solve(moved, kSolverSteps);
  if (!goes_on()) return;
  for (Index v = 0; v < moved.size(); ++v) {
    const Vec3 before(level_.positions[v]);
    moved[v] = before + (moved[v] - before) * relaxation;
  }
  keep_in_box(moved);
  std::vector<Vec3f> positions;
  for (const Vec3& p : moved) positions.push_back(to_float(p));
  for (Index v = 0; v < positions.size(); ++v)
    if (fixed_[v] != 0) positions[v] = level_.positions[v];
  TentativeMoves moves(level_, std::move(positions));
  Index upright_at = TentativeMoves::kStart, near_at = TentativeMoves::kStart;
  do {
    keep_faces_upright(moves, upright_at);
  } while (!guard_.keep_faces_near(moves, near_at));
  level_.positions = moves.take_positions();
}

/// The sum again, over points inside the original's faces that the fit does not go by: these stand for their areas even
/// where large faces meet small ones at an angle.
double Fitting::forward_error() {
  const Mesh& original = original_.mesh;
  update_walk();
  const std::vector<Index> near = faces_of_samples();
  const std::size_t count = std::clamp(kCheckedPoints / original.face_count(), kFewestOfFace, kMostOfFace);
  const std::size_t step = std::max<std::size_t>(original.face_count() * count / kCheckedPoints, 1);
  double sum = 0;
  Index face = 0;
  for (std::size_t i = 0; i < original_.face_order.size() && steps_.next(); i += step) {
    const Index f = original_.face_order[i];
    const Index known = near[original.corner_vertex(3 * f)];
    if (known != kNoIndex) face = known;
    const auto [a, b, c] = corners_at(original, original.positions, f);
    double sum_of_face = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const SurfaceWalk::Place place = walk_->nearest_from(point_on_triangle(a, b, c, k + 1), face);
      sum_of_face += norm_.error(place.on.squared_distance);
      face = place.face;
    }
    sum += 0.5 * length(area_vector(original, f)) * sum_of_face;
  }
  return sum * static_cast<double>(step) / static_cast<double>(count);
}

/// Where the samples at each vertex of the original, or one of them, belong.
std::vector<Index> Fitting::faces_of_samples() const {
  std::vector<Index> faces(original_.mesh.vertex_count(), kNoIndex);
  for (const SurfaceSample& sample : samples_.all()) faces[sample.vertex] = sample.face;
  return faces;
}

/// Where the work is cancelled the level is left anywhere.
void Fitting::run() {
  start();
  if (progress_.is_cancelled()) return;
  choose_norm();
  fence();
  double reach = 0;
  for (const SurfaceSample& sample : samples_.all()) reach = std::max(reach, std::sqrt(sample.squared_distance));
  guard_.set_reach(reach);
  const OriginalGuard::Survey survey = guard_.survey(level_, norm_);
  guard_.set_reach(std::max(reach, survey.farthest));
  const Mesh unfitted = level_;
  const double error_of_unfitted = is_fine_ ? forward_error() + survey.error : 0;
  double best = error();
  Mesh best_level = level_;
  progress_.reach(kFirstShare);
  const Progress moves = progress_.part(1 - kFirstShare);
  bool is_smooth = true;  // each move has made things better
  for (int i = 0; i < effort_.moves && !progress_.is_cancelled(); ++i) {
    if (i < effort_.turning && freedom_ == Freedom::All) turn_edges(i == 0);
    const bool goes_beyond = i > 0 && is_smooth;
    move(goes_beyond ? kOverRelaxation : 1);
    const bool looks_everywhere = effort_.search_every > 0 && (i + 1) % effort_.search_every == 0;
    follow();
    if (looks_everywhere) search(mean_square());
    moves.reach(static_cast<double>(i + 1) / effort_.moves);
    const double now = error();
    const bool is_better = now < best;
    if (!is_better && !goes_beyond) break;
    is_smooth = is_smooth && is_better;
    if (!is_better) continue;
    const bool settled = now > effort_.settled * best;
    best = now;
    best_level = level_;
    if (settled && i + 1 >= effort_.turning) break;
  }
  if (progress_.is_cancelled()) return;
  level_ = std::move(best_level);
  walk_.reset();
  // Where most faces have no error yet there is little to gain, and the samples may mislead.
  if (is_fine_ && forward_error() + guard_.survey(level_, norm_).error > error_of_unfitted) level_ = unfitted;
}

/// Leaves out vertices and wedges that no face uses.
Mesh compacted(const Mesh& mesh, std::vector<Index>* source_vertex = nullptr) {
  std::vector<Index> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), Index{0});
  return pick_faces(mesh, faces, source_vertex);
}

}  // namespace

struct LevelFitter::Impl {
  Impl(const Mesh& mesh, const Progress& progress) : original(mesh, progress) {
    if (original.is_ready() && progress.add(0)) attributes.emplace(mesh);
  }

  Original original;
  std::optional<AttributeLookup> attributes;  // none where the work was cancelled
};

LevelFitter::LevelFitter(const Mesh& original, const Progress& progress)
    : impl_(std::make_unique<Impl>(original, progress)) {}
LevelFitter::~LevelFitter() = default;
LevelFitter::LevelFitter(LevelFitter&&) noexcept = default;
LevelFitter& LevelFitter::operator=(LevelFitter&&) noexcept = default;

Mesh LevelFitter::fit(const Mesh& level, const PlacementOptions& options) const {
  Mesh fitted = compacted(level);
  if (fitted.face_count() == 0 || impl_->original.mesh.face_count() == 0) return fitted;
  if (!impl_->attributes || !is_worth_fitting(fitted, impl_->original.mesh, options.effort)) return fitted;
  Mesh before = fitted;
  Fitting(impl_->original, fitted, options, Freedom::All).run();
  if (options.progress.is_cancelled()) return before;
  impl_->attributes->look_up(before, fitted);
  options.progress.reach(1);
  return fitted;
}

LevelFitter::Places LevelFitter::find_places(const Mesh& level, const PlacementOptions& options) const {
  Places places = {level.positions, 0};
  std::vector<Index> source;
  Mesh fitted = compacted(level, &source);
  if (fitted.face_count() == 0 || impl_->original.mesh.face_count() == 0 || !impl_->attributes) return places;
  Fitting fitting(impl_->original, fitted, options, Freedom::Heights);
  fitting.run();
  if (options.progress.is_cancelled()) return places;
  for (Index v = 0; v < source.size(); ++v) places.positions[source[v]] = fitted.positions[v];
  places.rms = std::sqrt(fitting.mean_square());
  options.progress.reach(1);
  return places;
}

Mesh optimise_placement(const Mesh& original, const Mesh& level, const PlacementOptions& options) {
  return LevelFitter(original, options.progress.part(0)).fit(level, options);
}

}  // namespace lodestone

// The cost of a removal joins three measures of what it changes:
//   V  the volume swept between the old faces and the new ones, memoryless, after Lindstrom, Turk: Fast and memory
//      efficient polygonal simplification (Visualization 1998);
//   D  the distance of everything removed so far to the surface that now stands for it, which keeps the total honest;
//   ΔK the change of the discrete curvature against the full mesh, after Kim, Hong, Kim.
// The pure metrics of Kim, Hong, Kim use the last alone. bench/README.md has the trials behind the constants.

#include "removal_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lodestone::detail {
namespace {

constexpr double kMinNormalCosine = 0.2;      // a new face may turn this far from the old one at its rim
constexpr double kMinShape = 1e-3;            // a new face's height over its longest edge
constexpr std::size_t kFullyRanked = 3;       // triangulations, by swept volume, whose distances are measured      //
                                              // triangulations, by swept volume, that are measured in full
constexpr double kBridgeWeight = 3;           // of new surface where the star had none, against distances of points
constexpr double kLineWeight = 1;             // of a border or feature line that moves
constexpr double kTieBreak = 0.2;             // weight of the volume swept, as a length, against a pure curvature error
constexpr double kMinCurvatureChange = 1e-4;  // radians; below it curvature no longer separates removals

double dihedral_share(const Vec3& a, const Vec3& b, const Vec3& normal_a, const Vec3& normal_b) {
  return 0.25 * length(b - a) * angle_between(normal_a, normal_b);
}

bool rejects(Verdict verdict) { return verdict != Verdict::Legal; }

}  // namespace

RemovalEvaluator::RemovalEvaluator(const SimplifyState& state, const SimplifyOptions& options)
    : state_(&state), options_(&options), ring_of_vertex_(state.mesh.vertex_count(), kNoIndex) {
  needs_angles_ = options.metric != Metric::Mean;
  needs_dihedrals_ = options.metric == Metric::Mean || options.metric == Metric::Principal;
  table_.resize(kTriangleNumberCount);
  // Ties are broken on the metric's own scale: K̄ is an angle, the others are lengths.
  const double diagonal = bounding_box(state.mesh).diagonal();
  tie_scale_ = options.metric == Metric::Gaussian && diagonal > 0 ? 1 / diagonal : 1;
}

Evaluation RemovalEvaluator::evaluate(Index vertex, RemovalRecord& record, Choice& choice) {
  if (const Verdict verdict = gather(vertex, record); rejects(verdict)) return {verdict};
  if (const Verdict verdict = check_closing_edge(); rejects(verdict)) return {verdict};
  for (std::size_t s = 0; s < sectors_.size(); ++s)
    if (const Verdict verdict = choose(sectors_[s], record.sectors[s], choice[s]); rejects(verdict)) return {verdict};
  return combine(vertex, record);
}

Verdict RemovalEvaluator::gather(Index vertex, RemovalRecord& record) {
  const Connectivity& mesh = state_->connectivity;
  mesh.gather_star(vertex, star_);
  if (star_.corners.size() > kMaxRing) return Verdict::Ring;
  if (star_.closed && star_.corners.size() < 3) return Verdict::Link;  // two faces back to back: no hole to fill
  const VertexKind kind = mesh.kind(vertex, star_);
  if (kind != VertexKind::Interior && kind != VertexKind::Border && kind != VertexKind::Feature) return Verdict::Locked;
  record.vertex = vertex;
  describe_sectors(mesh, star_, record.sectors);
  center_ = Vec3(state_->mesh.positions[vertex]);
  gather_ring(record);
  gather_normals(record);
  if (!gather_links(vertex)) return Verdict::Link;
  gather_outside_curvature();
  return Verdict::Legal;
}

void RemovalEvaluator::gather_ring(const RemovalRecord& record) {
  ring_vertex_.clear();
  ring_position_.clear();
  sectors_.clear();
  for (const SectorPatch& patch : record.sectors) {
    Sector& sector = sectors_.emplace_back();
    sector.patch = &patch;
    sector.ring_begin = ring_vertex_.size();
    // The last corner of an open sector is the first of the next one; only a border keeps it.
    const bool shares_last = record.sectors.size() > 1;
    const std::size_t own = patch.polygon.size() - (shares_last ? 1 : 0);
    for (std::size_t i = 0; i < own; ++i) {
      const Index v = state_->connectivity.vertex_of_wedge(patch.polygon[i]);
      ring_vertex_.push_back(v);
      ring_position_.push_back(Vec3(state_->mesh.positions[v]));
    }
  }
}

void RemovalEvaluator::gather_normals(const RemovalRecord& record) {
  const Connectivity& mesh = state_->connectivity;
  fine_corner_ = star_.corners;
  fine_normal_.resize(fine_corner_.size());
  outer_normal_.resize(fine_corner_.size());
  has_outer_.assign(fine_corner_.size(), 0);
  const auto corner_position = [&](Index corner) { return Vec3(state_->mesh.positions[mesh.vertex(corner)]); };
  for (std::size_t i = 0; i < fine_corner_.size(); ++i) {
    const Vec3& a = ring_position_[i];
    const Vec3& b = ring_position_[(i + 1) % ring_size()];
    fine_normal_[i] = cross(a - center_, b - center_);
    const Index outer = mesh.opposite(fine_corner_[i]);
    has_outer_[i] = outer != kNoIndex ? 1 : 0;
    if (needs_dihedrals_ && outer != kNoIndex) outer_normal_[i] = cross(a - b, corner_position(outer) - b);
  }
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    sectors_[s].normal = {};
    for (std::size_t i = 0; i < record.sectors[s].face_count(); ++i)
      sectors_[s].normal += fine_normal_[sectors_[s].ring_begin + i];
  }
}

/// Notes which ring vertices an edge joins; false where the ring meets itself or a face lies over the star.
bool RemovalEvaluator::gather_links(Index vertex) {
  const Connectivity& mesh = state_->connectivity;
  bool simple = true;
  for (Index i = 0; i < ring_size(); ++i) {
    simple = simple && ring_of_vertex_[ring_vertex_[i]] == kNoIndex;
    ring_of_vertex_[ring_vertex_[i]] = i;
  }
  linked_.assign(ring_size() * ring_size(), 0);
  const auto link = [&](Index from, Index to_vertex) {
    const Index to = ring_of_vertex_[to_vertex];
    if (to != kNoIndex) linked_[from * ring_size() + to] = linked_[to * ring_size() + from] = 1;
  };
  for (Index i = 0; i < ring_size() && ring_size() > 2; ++i) {
    const Index start = mesh.corner_at(ring_vertex_[i]);
    Index corner = start;
    for (Index left = start; left != kNoIndex;) {
      corner = left;
      link(i, mesh.vertex(next_corner(corner)));
      left = mesh.swing_left(corner);
      if (left == start) break;
    }
    link(i, mesh.vertex(previous_corner(corner)));  // at a border no other corner has seen it
  }
  for (const Index v : ring_vertex_) ring_of_vertex_[v] = kNoIndex;
  if (ring_size() == 3 && star_.closed) {
    const Index outer = mesh.opposite(fine_corner_[0]);
    simple = simple && !(outer != kNoIndex && mesh.vertex(outer) == ring_vertex_[2]);
  }
  return simple && ring_vertex_[0] != vertex;
}

void RemovalEvaluator::gather_outside_curvature() {
  outside_.resize(ring_size());
  for (std::size_t i = 0; i < ring_size(); ++i) outside_[i] = state_->curvature[ring_vertex_[i]];
  for (std::size_t i = 0; i < fine_corner_.size(); ++i) {
    const std::size_t j = (i + 1) % ring_size();
    const Vec3& a = ring_position_[i];
    const Vec3& b = ring_position_[j];
    const double share = length(fine_normal_[i]) / 6;
    outside_[i].area -= share;
    outside_[j].area -= share;
    if (needs_angles_) {
      outside_[i].gaussian += angle_between(center_ - a, b - a);
      outside_[j].gaussian += angle_between(a - b, center_ - b);
    }
    if (!needs_dihedrals_) continue;
    if (has_outer_[i] != 0) {
      const double rim = dihedral_share(a, b, fine_normal_[i], outer_normal_[i]);
      outside_[i].mean -= rim;
      outside_[j].mean -= rim;
    }
    if (i > 0 || star_.closed) {
      const Vec3& before = fine_normal_[i > 0 ? i - 1 : fine_corner_.size() - 1];
      outside_[i].mean -= dihedral_share(center_, a, before, fine_normal_[i]);
    }
  }
}

Verdict RemovalEvaluator::check_closing_edge() const {
  if (sectors_[0].patch->closed) return Verdict::Legal;
  const bool is_border = sectors_.size() == 1;
  if (ring_size() == 2) {
    // A border ear: its one face goes, and the edge behind it becomes the border.
    return is_border && has_outer_[0] != 0 ? Verdict::Legal : Verdict::Link;
  }
  const std::size_t first = 0;
  const std::size_t last = ring_number(sectors_[0], sectors_[0].size() - 1);
  const bool lies_on_rim = std::any_of(sectors_.begin(), sectors_.end(), [](const Sector& s) { return s.size() == 2; });
  return !lies_on_rim && linked(first, last) ? Verdict::Link : Verdict::Legal;
}

void RemovalEvaluator::reset_triangles(std::size_t size) {
  if (size > kMaxTabulatedPolygon) return;
  const std::size_t used = size * (size - 1) * (size - 2) / 6;
  for (std::size_t i = 0; i < used; ++i) table_[i].known = table_[i].has_angles = table_[i].has_distances = false;
}

RemovalEvaluator::Triangle& RemovalEvaluator::triangle(const Sector& sector, PolygonTriangle t) {
  const bool is_tabulated = sector.size() <= kMaxTabulatedPolygon;
  Triangle& entry = is_tabulated ? table_[static_cast<std::size_t>(triangle_number(t))] : untabulated_;
  if (is_tabulated && entry.known) return entry;
  const Vec3& a = position(sector, t.a);
  entry.normal = cross(position(sector, t.b) - a, position(sector, t.c) - a);
  entry.volume = dot(entry.normal, center_ - a) / 6;
  entry.has_angles = entry.has_distances = false;
  entry.verdict = judge(sector, t, entry);
  entry.known = true;
  return entry;
}

Verdict RemovalEvaluator::judge(const Sector& sector, PolygonTriangle t, const Triangle& entry) const {
  const double square_area = squared_length(entry.normal);
  const double longest = std::max({squared_length(position(sector, t.b) - position(sector, t.a)),
                                   squared_length(position(sector, t.c) - position(sector, t.b)),
                                   squared_length(position(sector, t.a) - position(sector, t.c))});
  if (!(square_area > kMinShape * kMinShape * longest * longest)) return Verdict::Flip;
  bool at_rim = false;
  for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}}) {
    if (!is_rim(sector, from, to)) {
      const bool is_closing = from + 1U == sector.size() && to == 0;
      if (!is_closing && linked(ring_number(sector, from), ring_number(sector, to))) return Verdict::Link;
      continue;
    }
    at_rim = true;
    const Vec3& fine = fine_normal_[sector.ring_begin + from];
    const double cosine = dot(entry.normal, fine);
    if (cosine < 0 || cosine * cosine < kMinNormalCosine * kMinNormalCosine * square_area * squared_length(fine))
      return Verdict::Flip;
  }
  return at_rim || dot(entry.normal, sector.normal) > 0 ? Verdict::Legal : Verdict::Flip;
}

Verdict RemovalEvaluator::judge(const Sector& sector, Triangles triangles) {
  for (const PolygonTriangle t : triangles)
    if (const Verdict verdict = triangle(sector, t).verdict; rejects(verdict)) return verdict;
  return Verdict::Legal;
}

/// Triangulation `which` of a sector's polygon: from the table, or the fan from corner `which` of a large polygon.
RemovalEvaluator::Triangles RemovalEvaluator::candidate(const Sector& sector, int which) {
  const auto size = static_cast<int>(sector.size());
  if (size <= kMaxTabulatedPolygon) return triangulation(size, which);
  fan_.clear();
  for (int i = 1; i + 1 < size; ++i) {
    std::array<int, 3> corner{which, (which + i) % size, (which + i + 1) % size};
    std::sort(corner.begin(), corner.end());
    fan_.push_back({static_cast<std::uint8_t>(corner[0]), static_cast<std::uint8_t>(corner[1]),
                    static_cast<std::uint8_t>(corner[2])});
  }
  return fan_;
}

double RemovalEvaluator::squared_volume_sum(const Sector& sector, Triangles triangles) {
  double sum = 0;
  for (const PolygonTriangle t : triangles) {
    const double volume = triangle(sector, t).volume;
    sum += volume * volume;
  }
  return sum;
}

/// Fills `ranked_` with the admissible triangulations and their squared swept volumes.
Verdict RemovalEvaluator::list_admissible(const Sector& sector) {
  const auto size = static_cast<int>(sector.size());
  const int count = size <= kMaxTabulatedPolygon ? triangulation_count(size) : size;
  ranked_.clear();
  Verdict verdict = Verdict::Flip;
  for (int which = 0; which < count; ++which) {
    const Triangles triangles = candidate(sector, which);
    const Verdict found = judge(sector, triangles);
    if (found == Verdict::Link) verdict = Verdict::Link;
    if (found == Verdict::Legal) ranked_.emplace_back(squared_volume_sum(sector, triangles), which);
  }
  return ranked_.empty() ? verdict : Verdict::Legal;
}

/// Picks the best triangulation of a sector, trying `choice` alone where it names one that is still admissible.
Verdict RemovalEvaluator::choose(Sector& sector, SectorPatch& patch, std::uint8_t& choice) {
  patch.triangles.clear();
  if (sector.size() == 2) return Verdict::Legal;
  reset_triangles(sector.size());
  const bool is_hybrid = options_->metric == Metric::Hybrid;
  if (is_hybrid) gather_points(sector);
  if (choice == kNoChoice || rejects(judge(sector, candidate(sector, choice)))) {
    if (const Verdict verdict = list_admissible(sector); rejects(verdict)) return verdict;
    choice = static_cast<std::uint8_t>(is_hybrid ? best_by_distance(sector) : best_by_curvature(sector));
  }
  const Triangles chosen = candidate(sector, choice);
  patch.triangles.assign(chosen.begin(), chosen.end());
  return Verdict::Legal;
}

/// Ranks by (V·D)^6 = squared volume · D^6; the curvature's part is left to the order of removals.
int RemovalEvaluator::best_by_distance(const Sector& sector) {
  std::sort(ranked_.begin(), ranked_.end());
  if (ranked_.size() > kFullyRanked) ranked_.resize(kFullyRanked);
  for (auto& [rank, which] : ranked_) rank *= std::pow(squared_distance_sum(sector, candidate(sector, which)), 3);
  return std::min_element(ranked_.begin(), ranked_.end())->second;
}

int RemovalEvaluator::best_by_curvature(Sector& sector) {
  for (auto& [rank, which] : ranked_) rank = curvature_change(sector, candidate(sector, which)) + tie_break(rank);
  return std::min_element(ranked_.begin(), ranked_.end())->second;
}

/// What orders removals that leave the curvature (nearly) as it is, as on any developable surface: the volume they
/// sweep.
double RemovalEvaluator::tie_break(double squared_volume) const {
  return kTieBreak * tie_scale_ * std::cbrt(std::sqrt(squared_volume));
}

void RemovalEvaluator::gather_points(const Sector& sector) {
  points_.clear();
  weights_.assign(1, 1.0F);
  points_.add({});
  for (const Index face : sector.patch->faces)
    for (Index p = state_->points.first(face); p != kNoIndex; p = state_->points.next(p))
      points_.add(state_->points.position(p) - center_), weights_.push_back(state_->points.weight(p));
}

void RemovalEvaluator::measure_distances(const Sector& sector, PolygonTriangle t, Triangle& entry) {
  entry.squared_distance.resize(points_.padded_size());
  squared_distances(points_,
                    {position(sector, t.a) - center_, position(sector, t.b) - center_, position(sector, t.c) - center_},
                    entry.squared_distance.data());
  entry.has_distances = true;
}

double RemovalEvaluator::squared_distance_sum(const Sector& sector, Triangles triangles) {
  nearest_.assign(points_.size(), std::numeric_limits<float>::infinity());
  for (const PolygonTriangle t : triangles) {
    Triangle& entry = triangle(sector, t);
    if (!entry.has_distances) measure_distances(sector, t, entry);
    for (std::size_t i = 0; i < nearest_.size(); ++i) nearest_[i] = std::min(nearest_[i], entry.squared_distance[i]);
  }
  double sum = 0;
  for (std::size_t i = 0; i < nearest_.size(); ++i) sum += static_cast<double>(weights_[i] * nearest_[i]);
  return sum;
}

double RemovalEvaluator::curvature_change(Sector& sector, Triangles triangles) {
  after_ = outside_;
  add_coarse_curvature(sector, triangles);
  return largest_change();
}

/// Adds what a sector's coarse faces contribute to the curvature of the ring, but for the closing edge's angle.
void RemovalEvaluator::add_coarse_curvature(Sector& sector, Triangles triangles) {
  const std::size_t size = sector.size();
  if (needs_dihedrals_) has_edge_normal_.assign(size * size, 0), edge_normal_.resize(size * size);
  for (const PolygonTriangle t : triangles) {
    Triangle& entry = triangle(sector, t);
    const std::array<std::size_t, 3> corner{t.a, t.b, t.c};
    const double share = length(entry.normal) / 6;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t from = corner[i];
      const std::size_t to = corner[(i + 1) % 3];
      const Vec3& p = position(sector, from);
      const Vec3& q = position(sector, to);
      VertexCurvature& at = after_[ring_number(sector, from)];
      at.area += share;
      if (needs_angles_) {
        if (!entry.has_angles) entry.angle[i] = angle_between(q - p, position(sector, corner[(i + 2) % 3]) - p);
        at.gaussian -= entry.angle[i];
      }
      if (!needs_dihedrals_) continue;
      double angle_share = 0;
      if (is_rim(sector, from, to)) {
        const std::size_t rim = sector.ring_begin + from;
        if (has_outer_[rim] != 0) angle_share = dihedral_share(p, q, entry.normal, outer_normal_[rim]);
      } else if (from + 1 == size && to == 0) {
        sector.closing_normal = entry.normal;
      } else if (has_edge_normal_[to * size + from] != 0) {
        angle_share = dihedral_share(p, q, entry.normal, edge_normal_[to * size + from]);
      } else {
        has_edge_normal_[from * size + to] = 1;
        edge_normal_[from * size + to] = entry.normal;
      }
      at.mean += angle_share;
      after_[ring_number(sector, to)].mean += angle_share;
    }
    entry.has_angles = true;
  }
}

/// Adds the angle between the two sides of a feature line at its new edge.
void RemovalEvaluator::add_closing_curvature() {
  if (!needs_dihedrals_ || sectors_.size() != 2 || sectors_[0].size() == 2 || sectors_[1].size() == 2) return;
  const std::size_t first = 0;
  const std::size_t last = ring_number(sectors_[0], sectors_[0].size() - 1);
  const double share = dihedral_share(ring_position_[first], ring_position_[last], sectors_[0].closing_normal,
                                      sectors_[1].closing_normal);
  after_[first].mean += share;
  after_[last].mean += share;
}

double RemovalEvaluator::largest_change() const {
  double largest = 0;
  for (std::size_t i = 0; i < ring_size(); ++i) {
    const double before = options_->reference == Reference::Original
                              ? static_cast<double>(state_->original_curvature[ring_vertex_[i]])
                              : metric_curvature(*options_, state_->curvature[ring_vertex_[i]]);
    largest = std::max(largest, std::abs(before - metric_curvature(*options_, after_[i])));
  }
  return largest;
}

/// Sums the squared distances of the coarse faces' centroids and their new edges' midpoints to the star: the surface
/// where nothing was, as over a notch that the carried points do not see.
double RemovalEvaluator::bridge_sum(const Sector& sector, Triangles triangles) {
  points_.clear();
  for (const PolygonTriangle t : triangles) {
    const Vec3& a = position(sector, t.a);
    const Vec3& b = position(sector, t.b);
    const Vec3& c = position(sector, t.c);
    points_.add((a + b + c) * (1.0 / 3) - center_);
    for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}})
      if (!is_rim(sector, from, to) && (from < to || from + 1U == sector.size()))
        points_.add((position(sector, from) + position(sector, to)) * 0.5 - center_);
  }
  nearest_.assign(points_.size(), std::numeric_limits<float>::infinity());
  distance_.resize(points_.padded_size());
  for (std::size_t i = 0; i < sector.patch->face_count(); ++i) {
    squared_distances(points_, {Vec3{}, position(sector, i) - center_, position(sector, i + 1) - center_},
                      distance_.data());
    for (std::size_t p = 0; p < nearest_.size(); ++p) nearest_[p] = std::min(nearest_[p], distance_[p]);
  }
  return std::accumulate(nearest_.begin(), nearest_.end(), 0.0);
}

/// What a border or feature line is charged for its own displacement: √(√A · D) with A the area it sweeps and D the
/// distance of all its removed vertices to the new edge, a length.
double RemovalEvaluator::line_cost(Index vertex) const {
  if (sectors_[0].patch->closed) return 0;
  const std::size_t last = ring_number(sectors_[0], sectors_[0].size() - 1);
  const Vec3& a = ring_position_[0];
  const Vec3& b = ring_position_[last];
  double squared_distance = squared_distance_to_segment(center_, a, b);
  for (const Index neighbour : {ring_vertex_[0], ring_vertex_[last]})
    for (const Index removed : state_->lines.removed_between(neighbour, vertex))
      squared_distance += squared_distance_to_segment(Vec3(state_->mesh.positions[removed]), a, b);
  const double area = 0.5 * length(cross(a - center_, b - center_));
  return std::sqrt(std::sqrt(area) * std::sqrt(squared_distance));
}

Evaluation RemovalEvaluator::combine(Index vertex, const RemovalRecord& record) {
  after_ = outside_;
  double squared_volume = 0;
  double squared_distance = 0;
  const bool is_hybrid = options_->metric == Metric::Hybrid;
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    Sector& sector = sectors_[s];
    const Triangles triangles = record.sectors[s].triangles;
    if (sectors_.size() > 1) reset_triangles(sector.size());
    add_coarse_curvature(sector, triangles);
    if (triangles.empty()) continue;
    squared_volume += squared_volume_sum(sector, triangles);
    if (!is_hybrid) continue;
    if (sectors_.size() > 1) gather_points(sector);
    squared_distance += squared_distance_sum(sector, triangles) + kBridgeWeight * bridge_sum(sector, triangles);
  }
  add_closing_curvature();
  Evaluation result{Verdict::Legal, 0, largest_change()};
  result.cost = result.curvature_error + tie_break(squared_volume);
  if (!is_hybrid) return result;
  const double swept = std::sqrt(std::cbrt(std::sqrt(squared_volume)) * std::sqrt(squared_distance));
  const double moved = swept + kLineWeight * line_cost(vertex);
  result.cost = std::pow(moved, 0.9) * std::pow(std::max(result.curvature_error, kMinCurvatureChange), 0.1);
  return result;
}

}  // namespace lodestone::detail

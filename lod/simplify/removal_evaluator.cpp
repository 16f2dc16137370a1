#include "simplify/removal_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "simplify/site_walk.h"

namespace lodestone::detail {
namespace {

constexpr double kLineWeight = 1.5;    // of a border or crease that moves
constexpr double kLeastLine = 1.5;     // of its distance, where a border or crease that moves is short
constexpr double kMaterialWeight = 4;  // of a border between materials that moves: faces change their colour
constexpr double kSeamWeight = 0.1;    // of a seam that moves: what counts there is the price of the attributes
constexpr double kTieBreak = 0.2;      // weight of the volume swept, as a length, against a pure curvature error

double dihedral_share(const Vec3& a, const Vec3& b, const Vec3& normal_a, const Vec3& normal_b) {
  return 0.25 * length(b - a) * angle_between(normal_a, normal_b);
}

}  // namespace

bool take_better(Evaluation& best, const Evaluation& found) {
  if (rejects(found.verdict)) {
    if (rejects(best.verdict)) best.verdict = found.verdict;
    return false;
  }
  if (!rejects(best.verdict) && best.cost <= found.cost) return false;
  best = found;
  return true;
}

RemovalEvaluator::RemovalEvaluator(const SimplifyState& state, const SimplifyOptions& options,
                                   const AttributeCost& attributes, const FaceRules& rules, bool short_path)
    : state_(&state),
      options_(&options),
      attributes_(&attributes),
      rules_(&rules),
      plain_(state, options, attributes, rules),
      ring_of_site_(state.mesh.vertex_count(), kNoIndex) {
  takes_short_path_ = short_path && tracks_gaussian_curvature(options);
  fully_ranked_ = measured_triangulations(options);
  needs_angles_ = options.metric != Metric::Mean;
  needs_dihedrals_ = options.metric == Metric::Mean || options.metric == Metric::Principal;
  table_.resize(triangle_count(kMaxSearchedPolygon));
  // Ties are broken on the metric's own scale: K̄ is an angle, the others are lengths.
  const double diagonal = bounding_box(state.mesh).diagonal();
  tie_scale_ = options.metric == Metric::Gaussian && diagonal > 0 ? 1 / diagonal : 1;
  const Mesh& mesh = state.mesh;
  if (mesh.wedge_count() == mesh.vertex_count()) return;
  wedges_ = Grouping(mesh.vertex_count(), mesh.wedge_count(), [&](Index wedge) { return mesh.wedge_vertex[wedge]; });
}

Evaluation RemovalEvaluator::evaluate(Index vertex, Choice& choice) {
  if (gather_plain(vertex)) return plain_.evaluate(choice);
  return evaluate_star(vertex, scratch_, choice);
}

Evaluation RemovalEvaluator::describe(Index vertex, Choice& choice, Removal& removal, std::vector<double>& curvature) {
  curvature.clear();
  if (choice[1] != kPlain || !gather_plain(vertex)) return evaluate_star(vertex, removal, choice);
  removal.resize(1);
  return plain_.describe(choice, removal.front(), curvature);
}

bool RemovalEvaluator::gather_plain(Index vertex) {
  return takes_short_path_ && !state_->connectivity.is_copy(vertex) && plain_.gather(vertex);
}

/// Evaluates any removal; `removal` holds the records with the triangles chosen.
Evaluation RemovalEvaluator::evaluate_star(Index vertex, Removal& removal, Choice& choice) {
  if (state_->connectivity.is_copy(vertex)) return evaluate_copies(vertex, removal, choice);
  removal.resize(1);
  if (const Verdict verdict = gather(vertex); rejects(verdict)) return {verdict};
  const VertexKind kind = state_->connectivity.kind(vertex, star_);
  if (kind == VertexKind::Corner) return evaluate_corner(removal.front(), choice);
  return evaluate_hole(removal.front(), choice);
}

Evaluation RemovalEvaluator::evaluate_hole(RemovalRecord& record, Choice& choice) {
  describe_removal(state_->connectivity, star_, record);
  take_sectors(record, 0);
  if (const Verdict verdict = check_closing_edge(); rejects(verdict)) return {verdict};
  for (std::size_t s = 0; s < sectors_.size(); ++s)
    if (const Verdict verdict = choose(sectors_[s], record.sectors[s], choice[s]); rejects(verdict)) return {verdict};
  return combine(record);
}

/// Tries the spokes a corner may move along: the constrained ones, and the others where none of those will do.
Evaluation RemovalEvaluator::evaluate_corner(RemovalRecord& record, Choice& choice) {
  if (choice[0] != kNoChoice && is_target(choice[0])) {
    const Evaluation again = evaluate_collapse(choice[0], record);
    if (!rejects(again.verdict)) return again;
  }
  Evaluation best{Verdict::Link};
  for (const bool constrained : {true, false}) {
    for (std::size_t spoke = 0; spoke < ring_size(); ++spoke) {
      if (!is_target(spoke) || is_constrained_spoke(spoke) != constrained) continue;
      if (!take_better(best, evaluate_collapse(spoke, trial_))) continue;
      choice[0] = static_cast<std::uint8_t>(spoke);
      std::swap(record, trial_);
    }
    if (!rejects(best.verdict)) break;
  }
  return best;
}

Evaluation RemovalEvaluator::evaluate_collapse(std::size_t target, RemovalRecord& record) {
  const Connectivity& mesh = state_->connectivity;
  if (star_.is_plain()) {
    describe_removal(mesh, star_, record);
  } else {
    describe_collapse(mesh, star_, static_cast<Index>(target), record);
    for (SectorPatch& sector : record.sectors)
      if (sector.shape == SectorShape::Moved) sector.polygon.back() = best_wedge(ring_vertex_[target], sector.center);
  }
  take_sectors(record, target);
  if (const Verdict verdict = check_target(target); rejects(verdict)) return {verdict};
  for (std::size_t s = 0; s < sectors_.size(); ++s)
    if (const Verdict verdict = fill_with_fan(sectors_[s], record.sectors[s], target); rejects(verdict))
      return {verdict};
  return combine(record);
}

/// Looks at everything around the vertex that does not depend on how its hole is filled.
Verdict RemovalEvaluator::gather(Index vertex) {
  const Connectivity& mesh = state_->connectivity;
  mesh.gather_star(vertex, star_);
  if (star_.corners.size() > kMaxRing) return Verdict::Ring;
  if (star_.closed && star_.corners.size() < 3) return Verdict::Link;  // two faces back to back: no hole to fill
  center_ = Vec3(state_->mesh.positions[vertex]);
  gather_ring();
  gather_normals();
  if (!gather_links(vertex)) return Verdict::Link;
  gather_outside_curvature();
  return Verdict::Legal;
}

void RemovalEvaluator::gather_ring() {
  const Connectivity& mesh = state_->connectivity;
  ring_vertex_.clear();
  ring_position_.clear();
  for (const Index corner : star_.corners) ring_vertex_.push_back(mesh.vertex(next_corner(corner)));
  if (!star_.closed) ring_vertex_.push_back(mesh.vertex(previous_corner(star_.corners.back())));
  for (const Index v : ring_vertex_) ring_position_.push_back(Vec3(state_->mesh.positions[v]));
}

void RemovalEvaluator::gather_normals() {
  const Connectivity& mesh = state_->connectivity;
  fine_corner_ = star_.corners;
  fine_normal_.resize(fine_corner_.size());
  has_direction_.resize(fine_corner_.size());
  outer_normal_.resize(fine_corner_.size());
  has_outer_.assign(fine_corner_.size(), 0);
  bends_.assign(fine_corner_.size(), 0);
  const Index site = mesh.site(mesh.vertex(fine_corner_.front()));
  const auto corner_position = [&](Index corner) { return Vec3(state_->mesh.positions[mesh.vertex(corner)]); };
  for (std::size_t i = 0; i < fine_corner_.size(); ++i) {
    const Vec3& a = ring_position_[i];
    const Vec3& b = ring_position_[(i + 1) % ring_size()];
    fine_normal_[i] = cross(a - center_, b - center_);
    has_direction_[i] =
        rules_->has_direction(squared_length(fine_normal_[i]), squared_longest_edge(center_, a, b)) ? 1 : 0;
    const Index outer = mesh.opposite(fine_corner_[i]);
    has_outer_[i] = outer != kNoIndex && mesh.site(mesh.vertex(outer)) != site ? 1 : 0;
    bends_[i] = outer != kNoIndex && !mesh.is_crease(fine_corner_[i]) ? 1 : 0;
    if (needs_dihedrals_ && outer != kNoIndex) outer_normal_[i] = cross(a - b, corner_position(outer) - b);
  }
}

/// Notes which ring vertices an edge joins, in any sheet; false where the ring meets itself or a face lies over the
/// star.
bool RemovalEvaluator::gather_links(Index vertex) {
  const Connectivity& mesh = state_->connectivity;
  bool simple = true;
  for (Index i = 0; i < ring_size(); ++i) {
    Index& ring = ring_of_site_[mesh.site(ring_vertex_[i])];
    simple = simple && ring == kNoIndex;
    ring = i;
  }
  linked_.assign(ring_size() * ring_size(), 0);
  const auto link = [&](Index from, Index at, Index to_vertex) {
    const Index to = ring_of_site_[mesh.site(to_vertex)];
    if (to == kNoIndex) return;
    const bool here = at == ring_vertex_[from] && to_vertex == ring_vertex_[to];
    for (std::uint8_t* l : {&linked_[from * ring_size() + to], &linked_[to * ring_size() + from]})
      *l = *l | (here ? kLinkedHere : kLinkedElsewhere);
  };
  for (Index i = 0; i < ring_size() && ring_size() > 2; ++i)
    for_each_neighbour(mesh, ring_vertex_[i], [&](Index at, Index neighbour) { link(i, at, neighbour); });
  for (const Index v : ring_vertex_) ring_of_site_[mesh.site(v)] = kNoIndex;
  if (ring_size() == 3 && star_.closed) {
    const Index second = mesh.site(ring_vertex_[1]), third = mesh.site(ring_vertex_[2]);
    simple =
        simple && !has_face(mesh, ring_vertex_[0], second, third) && !has_face(mesh, ring_vertex_[0], third, second);
  }
  return simple && ring_vertex_[0] != vertex;
}

/// Whether the vertex may move along a spoke at all: a border vertex only along the border, and a vertex at which one
/// line ends not along that line, which would have nowhere to end.
bool RemovalEvaluator::is_target(std::size_t spoke) const {
  if (spoke >= ring_size()) return false;
  if (!star_.closed) return spoke == 0 || spoke + 1 == ring_size();
  return star_.is_plain() || star_.sector_count() > 1 || spoke != 0;
}

bool RemovalEvaluator::is_constrained_spoke(std::size_t spoke) const {
  if (!star_.closed && spoke + 1 == ring_size()) return true;
  return star_.starts_constrained &&
         std::binary_search(star_.sector_begin.begin(), star_.sector_begin.end(), static_cast<Index>(spoke));
}

/// Seams weigh little: what a seam's displacement does is in the price of the attributes.
double RemovalEvaluator::line_weight(std::size_t spoke) const {
  if (!star_.closed && (spoke == 0 || spoke + 1 == ring_size())) return kLineWeight;
  const Connectivity& mesh = state_->connectivity;
  const Index after = star_.corners[spoke];
  const Index before = star_.corners[spoke > 0 ? spoke - 1 : star_.corners.size() - 1];
  if (mesh.is_crease(previous_corner(after))) return kLineWeight;
  return mesh.material(face_of_corner(after)) != mesh.material(face_of_corner(before)) ? kMaterialWeight : kSeamWeight;
}

/// The wedge of `vertex` whose attributes are most like those of another.
Index RemovalEvaluator::best_wedge(Index vertex, Index like) const {
  if (wedges_.empty()) return vertex;  // never: without seams there are no corners that move
  AttributeScale scale{1, std::vector<double>(attributes_->texture_count(), 1), {}};
  Index best = wedges_[vertex].front();
  double least = std::numeric_limits<double>::infinity();
  for (const Index wedge : wedges_[vertex]) {
    const double difference = attributes_->squared_difference(like, {{wedge, wedge, wedge}, {1, 0, 0}}, scale);
    if (difference < least) least = difference, best = wedge;
  }
  return best;
}

/// Lays out the record's sectors in ring terms; `target` is the spoke that moved sectors end at.
void RemovalEvaluator::take_sectors(RemovalRecord& record, std::size_t target) {
  sectors_.clear();
  std::size_t ring_begin = 0;
  for (const SectorPatch& patch : record.sectors) {
    Sector& sector = sectors_.emplace_back();
    sector.patch = &patch;
    sector.ring_begin = ring_begin;
    sector.target = target;
    gather_faces(sector);
    if (!attributes_->empty()) sector.scale = attribute_scale(patch, ring_begin);
    ring_begin += patch.face_count();
  }
  take_lines(target);
}

/// Lists the lines that move: from the target to the far end of every other constrained spoke.
void RemovalEvaluator::take_lines(std::size_t target) {
  lines_.clear();
  for (std::size_t spoke = 0; spoke < ring_size(); ++spoke)
    if (spoke != target && is_constrained_spoke(spoke))
      lines_.push_back({target, spoke, line_weight(spoke), lines_.empty() && is_constrained_spoke(target)});
}

/// Collects what a sector's new faces are compared with.
void RemovalEvaluator::gather_faces(Sector& sector) const {
  for (std::size_t i = sector.ring_begin; i < sector.ring_begin + sector.patch->face_count(); ++i)
    rules_->add(fine_normal_[i], squared_length(fine_normal_[i]),
                squared_longest_edge(center_, ring_position_[i], ring_position_[(i + 1) % ring_size()]), sector.faces);
}

AttributeScale RemovalEvaluator::attribute_scale(const SectorPatch& patch, std::size_t ring_begin) const {
  double area = 0;
  for (std::size_t i = 0; i < patch.face_count(); ++i) area += 0.5 * length(fine_normal_[ring_begin + i]);
  const bool wraps = patch.shape == SectorShape::Closed;
  const std::size_t size = patch.face_count() + (wraps ? 0 : 1);
  return attributes_->scale(patch.center, {patch.polygon.data(), size}, wraps, area);
}

void RemovalEvaluator::gather_outside_curvature() {
  outside_.resize(ring_size());
  for (std::size_t i = 0; i < ring_size(); ++i) outside_[i] = state_->curvature_at(ring_vertex_[i]);
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
    if (bends_[i] != 0) {
      const double rim = dihedral_share(a, b, fine_normal_[i], outer_normal_[i]);
      outside_[i].mean -= rim;
      outside_[j].mean -= rim;
    }
    if ((i > 0 || star_.closed) && !state_->connectivity.is_crease(previous_corner(fine_corner_[i]))) {
      const Vec3& before = fine_normal_[i > 0 ? i - 1 : fine_corner_.size() - 1];
      outside_[i].mean -= dihedral_share(center_, a, before, fine_normal_[i]);
    }
  }
}

Verdict RemovalEvaluator::check_closing_edge() const {
  if (sectors_[0].patch->shape == SectorShape::Closed) return Verdict::Legal;
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

/// Whether the lines that move to the target can lie there: no edge joins their ends yet but one of the rim.
Verdict RemovalEvaluator::check_target(std::size_t target) const {
  if (ring_size() == 2) return has_outer_[0] != 0 ? Verdict::Legal : Verdict::Link;
  const auto is_beside_target = [&](std::size_t spoke) {
    const std::size_t apart = spoke > target ? spoke - target : target - spoke;
    return apart == 1 || (star_.closed && apart + 1 == ring_size());
  };
  for (const Line& line : lines_)
    if (!is_beside_target(line.to) && linked(target, line.to)) return Verdict::Link;
  return Verdict::Legal;
}

/// Fills a sector with the fan of the target.
Verdict RemovalEvaluator::fill_with_fan(Sector& sector, SectorPatch& patch, std::size_t target) {
  patch.triangles.clear();
  const std::size_t size = sector.size();
  if (size == 2) return Verdict::Legal;
  std::size_t apex = size - 1;
  if (!sector.is_moved()) {
    apex = 0;
    while (ring_number(sector, apex) != target) ++apex;
  }
  const Triangles triangles = fills_.fan(size, apex);
  patch.triangles.assign(triangles.begin(), triangles.end());
  return judge_filled(sector, patch);
}

/// Judges the triangles that a sector has been given.
Verdict RemovalEvaluator::judge_filled(Sector& sector, const SectorPatch& patch) {
  if (sector.size() == 2) return Verdict::Legal;
  reset_triangles(sector.size());
  if (measures_distances()) gather_points(sector);
  return judge(sector, patch.triangles);
}

void RemovalEvaluator::reset_triangles(std::size_t size) {
  if (size > kMaxSearchedPolygon) return;
  const auto used = static_cast<std::size_t>(triangle_count(static_cast<int>(size)));
  for (std::size_t i = 0; i < used; ++i) table_[i].known = table_[i].has_angles = table_[i].has_distances = false;
}

RemovalEvaluator::Triangle& RemovalEvaluator::triangle(const Sector& sector, PolygonTriangle t) {
  const bool is_tabulated = sector.size() <= kMaxSearchedPolygon;
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
  const double square = squared_length(entry.normal);
  const double longest = squared_longest_edge(position(sector, t.a), position(sector, t.b), position(sector, t.c));
  if (rules_->is_too_thin(square, longest, sector.faces)) return Verdict::Shape;
  bool at_rim = false;
  for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}}) {
    if (!is_rim(sector, from, to)) {
      const bool is_closing = is_entry(sector, from, to) || is_exit(sector, from, to);
      if (!is_closing && linked(ring_number(sector, from), ring_number(sector, to))) return Verdict::Link;
      continue;
    }
    if (has_direction_[sector.ring_begin + from] == 0) continue;
    at_rim = true;
    if (rules_->turns_too_far(entry.normal, fine_normal_[sector.ring_begin + from])) return Verdict::Turn;
  }
  if (!at_rim && rules_->looks_away(entry.normal, sector.faces)) return Verdict::Turn;
  const std::vector<Index>& polygon = sector.patch->polygon;
  const bool turns = attributes_->turns_texture(polygon[t.a], polygon[t.b], polygon[t.c], sector.scale);
  return turns ? Verdict::Texture : Verdict::Legal;
}

/// Judges a whole triangulation; an empty one is none.
Verdict RemovalEvaluator::judge(const Sector& sector, Triangles triangles) {
  if (triangles.empty()) return Verdict::Shape;
  for (const PolygonTriangle t : triangles)
    if (const Verdict verdict = triangle(sector, t).verdict; rejects(verdict)) return verdict;
  return Verdict::Legal;
}

/// Triangulation `which` of a sector's polygon: from the table; of a large polygon the fan from corner `which`, or,
/// where that is past the last, the one of least volume. Empty where there is none.
RemovalEvaluator::Triangles RemovalEvaluator::candidate(const Sector& sector, int which) {
  const auto size = static_cast<int>(sector.size());
  if (size <= kMaxTabulatedPolygon) return triangulation(size, which);
  return which < size ? fills_.fan(sector.size(), static_cast<std::size_t>(which)) : least_volume(sector);
}

/// The admissible triangulation with the least sum of squared volumes.
RemovalEvaluator::Triangles RemovalEvaluator::least_volume(const Sector& sector) {
  if (sector.size() > kMaxSearchedPolygon) return {};
  const auto squared_volume = [&](PolygonTriangle t) {
    const double volume = triangle(sector, t).volume;
    return volume * volume;
  };
  return fills_.cheapest(sector.size(), squared_volume,
                         [&](PolygonTriangle t) { return !rejects(triangle(sector, t).verdict); });
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
  const int count = size <= kMaxTabulatedPolygon ? triangulation_count(size) : size + 1;
  ranked_.clear();
  Verdict verdict = Verdict::Ring;
  for (int which = 0; which < count; ++which) {
    const Triangles triangles = candidate(sector, which);
    const Verdict found = judge(sector, triangles);
    verdict = std::min(verdict, found);
    if (found == Verdict::Legal) ranked_.emplace_back(squared_volume_sum(sector, triangles), which);
  }
  return verdict;
}

/// Picks the best triangulation of a sector, trying `choice` alone where it names one that is still admissible.
Verdict RemovalEvaluator::choose(Sector& sector, SectorPatch& patch, std::uint8_t& choice) {
  patch.triangles.clear();
  if (sector.size() == 2) return Verdict::Legal;
  reset_triangles(sector.size());
  const bool is_hybrid = options_->metric == Metric::Hybrid;
  if (measures_distances()) gather_points(sector);
  if (choice == kNoChoice || rejects(judge(sector, candidate(sector, choice)))) {
    if (const Verdict verdict = list_admissible(sector); rejects(verdict)) return verdict;
    choice = static_cast<std::uint8_t>(is_hybrid ? best_by_distance(sector) : best_by_curvature(sector));
  }
  const Triangles chosen = candidate(sector, choice);
  patch.triangles.assign(chosen.begin(), chosen.end());
  return Verdict::Legal;
}

/// Ranks by (V·D)^6 = squared volume · D^6, or by volume alone; the curvature's part is left to the order of removals.
int RemovalEvaluator::best_by_distance(const Sector& sector) {
  const std::size_t count = measures_distances() ? std::min(fully_ranked_, ranked_.size()) : 1;
  std::partial_sort(ranked_.begin(), ranked_.begin() + static_cast<std::ptrdiff_t>(count), ranked_.end());
  ranked_.resize(count);
  if (count == 1) return ranked_.front().second;
  for (auto& [rank, which] : ranked_) rank *= std::pow(added_squared_distance(sector, candidate(sector, which)), 3);
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
  points_.start();
  for (const Index face : sector.patch->faces) points_.add_face(state_->points, face, center_);
}

void RemovalEvaluator::measure_distances(const Sector& sector, PolygonTriangle t, Triangle& entry) {
  entry.squared_distance.resize(points_.places.padded_size());
  squared_distances(points_.places,
                    {position(sector, t.a) - center_, position(sector, t.b) - center_, position(sector, t.c) - center_},
                    entry.squared_distance.data());
  entry.has_distances = true;
}

double RemovalEvaluator::added_squared_distance(const Sector& sector, Triangles triangles) {
  nearest_.assign(points_.places.size(), std::numeric_limits<float>::infinity());
  for (const PolygonTriangle t : triangles) {
    Triangle& entry = triangle(sector, t);
    if (!entry.has_distances) measure_distances(sector, t, entry);
    for (std::size_t i = 0; i < nearest_.size(); ++i) nearest_[i] = std::min(nearest_[i], entry.squared_distance[i]);
  }
  double sum = 0;
  for (std::size_t i = 0; i < nearest_.size(); ++i)
    sum += static_cast<double>(points_.weights[i] * rules_->beyond_rounding(nearest_[i]));
  return charged_distance(sum, points_.squared_distance_before);
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
        if (bends_[rim] != 0) angle_share = dihedral_share(p, q, entry.normal, outer_normal_[rim]);
      } else if (is_entry(sector, from, to) || is_exit(sector, from, to)) {
        if (is_entry(sector, from, to)) sector.entry_normal = entry.normal;
        if (is_exit(sector, from, to)) sector.exit_normal = entry.normal;
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

/// Adds the angles between neighbouring sectors at the edges where they now meet, but for creases.
void RemovalEvaluator::add_closing_curvature() {
  if (!needs_dihedrals_ || !star_.closed) return;
  for (std::size_t s = 0; s < sectors_.size() && sectors_.size() > 1; ++s) {
    const Sector& before = sectors_[(s + sectors_.size() - 1) % sectors_.size()];
    const Sector& sector = sectors_[s];
    if (before.size() == 2 || sector.size() == 2) continue;
    const bool both_open = !before.is_moved() && !sector.is_moved();
    if (both_open && (sectors_.size() > 2 || s == 0)) continue;  // no edge, or the one that the other turn sees
    if (sector.patch->starts_at_crease || (both_open && before.patch->starts_at_crease)) continue;
    const std::size_t from = ring_number(sector, sector.size() - 1);
    const std::size_t to = ring_number(sector, 0);
    const double share =
        dihedral_share(ring_position_[from], ring_position_[to], before.exit_normal, sector.entry_normal);
    after_[from].mean += share;
    after_[to].mean += share;
  }
}

double RemovalEvaluator::largest_change() const {
  double largest = 0;
  for (std::size_t i = 0; i < ring_size(); ++i) {
    const double before = options_->reference == Reference::Original
                              ? static_cast<double>(state_->original_curvature[ring_vertex_[i]])
                              : metric_curvature(*options_, state_->curvature_at(ring_vertex_[i]));
    largest = std::max(largest, std::abs(before - metric_curvature(*options_, after_[i])));
  }
  return largest;
}

/// Sums the squared distances of the coarse faces' centroids and their new edges' midpoints to the star: the surface
/// where nothing was, as over a notch that the carried points do not see.
double RemovalEvaluator::bridge_sum(const Sector& sector, Triangles triangles) {
  bridge_.clear();
  for (const PolygonTriangle t : triangles) {
    const Vec3& a = position(sector, t.a);
    const Vec3& b = position(sector, t.b);
    const Vec3& c = position(sector, t.c);
    bridge_.add((a + b + c) * (1.0 / 3) - center_);
    for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}})
      if (!is_rim(sector, from, to) && (from < to || (to == 0 && from + 1U == sector.size())))
        bridge_.add((position(sector, from) + position(sector, to)) * 0.5 - center_);
  }
  nearest_.assign(bridge_.size(), std::numeric_limits<float>::infinity());
  distance_.resize(bridge_.padded_size());
  for (std::size_t i = 0; i < sector.patch->face_count(); ++i) {
    squared_distances(bridge_, {Vec3{}, position(sector, i) - center_, position(sector, i + 1) - center_},
                      distance_.data());
    for (std::size_t p = 0; p < nearest_.size(); ++p) nearest_[p] = std::min(nearest_[p], distance_[p]);
  }
  double sum = 0;
  for (const float squared_distance : nearest_) sum += static_cast<double>(rules_->beyond_rounding(squared_distance));
  return sum;
}

/// What borders and feature lines are charged for their own displacement: √(√A · D) each, a length, with A the area it
/// sweeps and D the distance of all its removed vertices to the new edge; at least a multiple of D, which counts where
/// the edge is short beside it, as at the tip of an ear.
double RemovalEvaluator::line_cost(Index vertex) const {
  double sum = 0;
  for (const Line& line : lines_) {
    const Vec3& a = ring_position_[line.from];
    const Vec3& b = ring_position_[line.to];
    double squared_distance = squared_distance_to_segment(center_, a, b);
    const auto add_removed = [&](std::size_t neighbour) {
      for (const Index removed : state_->lines.removed_between(ring_vertex_[neighbour], vertex))
        squared_distance += squared_distance_to_segment(Vec3(state_->mesh.positions[removed]), a, b);
    };
    if (line.carries_from) add_removed(line.from);
    add_removed(line.to);
    const double area = 0.5 * length(cross(a - center_, b - center_));
    const double distance = squared_distance > rules_->rounded_square() ? std::sqrt(squared_distance) : 0;
    sum += line.weight * std::max(std::sqrt(std::sqrt(area) * distance), kLeastLine * distance);
  }
  return sum;
}

/// Compares the removed wedge's attributes with those of the nearest point of the sector's new faces.
double RemovalEvaluator::squared_attribute_difference(const Sector& sector, Triangles triangles) const {
  const auto position_at = [&](std::size_t k) { return state_->mesh.positions[ring_vertex_[ring_number(sector, k)]]; };
  const auto wedge_at = [&](std::size_t k) { return sector.patch->polygon[k]; };
  return attributes_->squared_difference(sector.patch->center, center_, triangles, position_at, wedge_at, sector.scale);
}

Evaluation RemovalEvaluator::combine(const RemovalRecord& record) {
  after_ = outside_;
  Displacement moved;
  const bool is_hybrid = options_->metric == Metric::Hybrid;
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    Sector& sector = sectors_[s];
    const Triangles triangles = record.sectors[s].triangles;
    if (sectors_.size() > 1) reset_triangles(sector.size());
    add_coarse_curvature(sector, triangles);
    if (triangles.empty()) continue;
    moved.squared_volume += squared_volume_sum(sector, triangles);
    if (!is_hybrid) continue;
    if (measures_distances()) {
      if (sectors_.size() > 1) gather_points(sector);
      moved.squared_distance +=
          joined_distance(added_squared_distance(sector, triangles), bridge_sum(sector, triangles));
    }
    if (!attributes_->empty()) moved.squared_attributes += squared_attribute_difference(sector, triangles);
  }
  add_closing_curvature();
  Evaluation result{Verdict::Legal, 0, largest_change()};
  if (is_hybrid) {
    moved.line = line_cost(record.vertex);
    result.cost = hybrid_cost(moved, measures_distances(), result.curvature_error);
  } else {
    result.cost = result.curvature_error + tie_break(moved.squared_volume);
  }
  return result;
}

}  // namespace lodestone::detail

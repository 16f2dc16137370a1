// Removal in rounds: each round takes the cheapest share of all vertices in order of (cost, number) and removes those
// whose rings do not meet. Within a round records commute, which keeps the order of work out of the result. Pieces that
// are nearly used up vanish as a whole once that costs no more than the round's removals.
// Costs: see removal_evaluator.cpp. Deviation bounds: see deviation_bounds.cpp.

#include <lodestone/lod/simplify.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/validate.h>

#include "distance/deviation_bounds.h"
#include "simplify/creases.h"
#include "simplify/locks.h"
#include "simplify/pieces.h"
#include "simplify/record_builder.h"
#include "simplify/removal_evaluator.h"
#include "simplify/spatial_order.h"

namespace lodestone {
namespace {

using namespace detail;

// Large meshes lose nothing by wide rounds; near the end every removal counts.
constexpr double kWideShare = 0.25;
constexpr double kNarrowShare = 0.05;
constexpr double kNarrowPureShare = 0.02;  // curvature alone leaves many ties, and their order matters
constexpr std::size_t kNarrowBelow = 8000;

// What cannot go below this by removals of vertices (a tetrahedron, a card) may vanish as a whole.
constexpr std::size_t kSmallPiece = 16;

// How many of the vertices left are looked at, along the curve and each way, for one near a piece that vanishes.
constexpr int kNearCandidates = 32;

// Faces may turn further, up to a right angle, once the limit on angles keeps this many vertices for each that can be
// removed, and below this share of the faces by any angle: thin parts get stuck otherwise. Any angle earlier would let
// spikes grow on rough surfaces, and right angles at once would make the bounds on the deviation useless.
constexpr double kCoarseShare = 0.05;
constexpr double kManyTurn = 0.05;

constexpr float kIllegal = std::numeric_limits<float>::infinity();

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, Connectivity connectivity, const SimplifyOptions& options)
      : options_(options),
        state_{mesh, std::move(connectivity), CarriedPoints(mesh), {}, {}, {}},
        evaluator_(state_, options_),
        builder_(mesh, state_.connectivity),
        bounds_(mesh, options.measure_step),
        locked_(find_locked(state_.connectivity, options_)),
        pieces_(mesh, state_.connectivity) {}

  SimplifyResult run();

 private:
  void prepare();
  bool is_locked(Index vertex) const { return !locked_.empty() && locked_[vertex] != 0; }
  void evaluate(Index vertex);
  bool choose_candidates();
  bool run_round();
  void try_remove(Index vertex);
  void remove(const Evaluation& evaluation);
  bool ring_is_free(Index vertex);
  void claim_ring(const RemovalRecord& record);
  void update_dirty();
  bool is_kept_by_turning(Index vertex) const;
  bool relax_angles(bool beyond_right_angles);
  bool target_met();
  void note_charge(double cost);
  std::vector<float> charges() const;

  void price_pieces();
  bool remove_pieces(bool stuck);
  std::vector<Index> choose_pieces(bool stuck);
  void remove_piece(Index piece);
  Index vertex_left_near(Index vertex, Index piece) const;

  BlockedCounts count_blocked() const;

  SimplifyOptions options_;
  SimplifyState state_;
  RemovalEvaluator evaluator_;
  RecordBuilder builder_;
  DeviationBounds bounds_;

  std::vector<std::uint8_t> locked_;  // by vertex; empty where none is

  Pieces pieces_;
  std::vector<float> piece_cost_;
  std::vector<float> piece_error_;         // curvature error, in the metric's own unit
  std::vector<std::uint8_t> piece_moves_;  // whether any of its vertices can be removed
  float limit_ = 0;                        // the cost that bounds this round's removals

  std::vector<float> charge_;  // by removal, in order
  std::vector<float> cost_;    // by vertex; of several copies the first stands for all
  std::vector<Verdict> verdict_;
  std::vector<Choice> choice_;
  std::vector<std::uint8_t> stale_;  // by vertex: whether its surroundings have changed since it was evaluated
  std::vector<Index> candidates_;
  std::vector<Index> claimed_;  // by vertex: the round that last claimed it, + 1
  std::vector<Index> dirty_;
  Index round_ = 0;
  Removal removal_;
  Star star_;
  StopReason stop_reason_ = StopReason::Stuck;
  std::size_t evaluation_count_ = 0;
};

void Simplifier::prepare() {
  const std::size_t count = state_.mesh.vertex_count();
  state_.curvature = vertex_curvatures(state_.mesh, state_.connectivity);
  state_.original_curvature.resize(count);
  for (Index v = 0; v < count; ++v)
    state_.original_curvature[v] = static_cast<float>(metric_curvature(options_, state_.curvature[v]));
  for (Index v = 0; v < options_.importance.size(); ++v) {
    float& of_all = options_.importance[state_.connectivity.site(v)];
    of_all = std::max(of_all, options_.importance[v]);
  }
  cost_.assign(count, kIllegal);
  choice_.assign(count, {kNoChoice, kNoChoice});
  stale_.assign(count, 0);
  verdict_.assign(count, Verdict::Locked);
  claimed_.assign(count, 0);
  for (Index v = 0; v < count; ++v)
    if (state_.connectivity.has_vertex(v) && state_.connectivity.site(v) == v) evaluate(v);
  price_pieces();
}

void Simplifier::evaluate(Index vertex) {
  choice_[vertex] = {kNoChoice, kNoChoice};
  if (is_locked(vertex)) return;  // as `prepare` left it
  Evaluation evaluation = evaluator_.evaluate(vertex, removal_, choice_[vertex]);
  ++evaluation_count_;
  if (!options_.importance.empty()) evaluation.cost *= static_cast<double>(options_.importance[vertex]);
  stale_[vertex] = 0;
  verdict_[vertex] = evaluation.verdict;
  const bool within = evaluation.curvature_error <= options_.stop.max_curvature_error;
  cost_[vertex] = evaluation.verdict == Verdict::Legal && within ? static_cast<float>(evaluation.cost) : kIllegal;
}

/// Fills `candidates_` with the cheapest share of the vertices, in order of (cost, number).
///
/// What costs nothing goes before all else, even where only a few of such vertices may go at once.
///
/// Costs mostly rise, so a vertex whose surroundings have changed keeps its old cost until that brings it in here; then
/// it is evaluated anew, and stays if it is still as cheap as the rest. Returns whether any vertex was left to look at.
bool Simplifier::choose_candidates() {
  candidates_.clear();
  std::fill(piece_moves_.begin(), piece_moves_.end(), std::uint8_t{0});
  std::size_t turning = 0;
  for (Index v = 0; v < cost_.size(); ++v) {
    if (is_kept_by_turning(v)) ++turning;
    if (cost_[v] == kIllegal) continue;
    candidates_.push_back(v);
    piece_moves_[pieces_.piece_of(v)] = 1;
  }
  if (candidates_.empty()) return false;
  const bool is_hybrid = options_.metric == Metric::Hybrid;
  const bool many_turn = static_cast<double>(turning) > kManyTurn * static_cast<double>(candidates_.size());
  const bool is_coarse = static_cast<double>(state_.connectivity.face_count()) <
                         kCoarseShare * static_cast<double>(state_.mesh.face_count());
  if (is_hybrid && many_turn && relax_angles(is_coarse)) return choose_candidates();
  const double narrow = is_hybrid ? kNarrowShare : kNarrowPureShare;
  const double share = candidates_.size() < kNarrowBelow ? narrow : kWideShare;
  const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(candidates_.size())));
  const auto cheaper = [&](Index a, Index b) { return cost_[a] != cost_[b] ? cost_[a] < cost_[b] : a < b; };
  const auto last = candidates_.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(candidates_.begin(), last, candidates_.end(), cheaper);
  const bool any_free = std::any_of(candidates_.begin(), last, [&](Index v) { return cost_[v] == 0; });
  limit_ = any_free ? 0 : cost_[*last];
  candidates_.resize(count);
  for (const Index v : candidates_)
    if (stale_[v] != 0) evaluate(v);
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), [&](Index v) { return cost_[v] > limit_; }),
                    candidates_.end());
  std::sort(candidates_.begin(), candidates_.end(), cheaper);
  return true;
}

/// Whether no removal of this round has touched the stars of the vertex and its copies.
bool Simplifier::ring_is_free(Index vertex) {
  const Connectivity& mesh = state_.connectivity;
  const auto is_claimed = [&](Index v) { return claimed_[mesh.site(v)] == round_ + 1; };
  if (is_claimed(vertex)) return false;
  for (Index copy = vertex;;) {
    mesh.gather_star(copy, star_);
    for (const Index corner : star_.corners)
      if (is_claimed(mesh.vertex(next_corner(corner))) || is_claimed(mesh.vertex(previous_corner(corner))))
        return false;
    copy = mesh.next_copy(copy);
    if (copy == vertex) return true;
  }
}

void Simplifier::claim_ring(const RemovalRecord& record) {
  const Connectivity& mesh = state_.connectivity;
  claimed_[mesh.site(record.vertex)] = round_ + 1;
  for (const SectorPatch& sector : record.sectors)
    for (const Index wedge : sector.polygon) {
      const Index site = mesh.site(mesh.vertex_of_wedge(wedge));
      if (claimed_[site] == round_ + 1) continue;
      claimed_[site] = round_ + 1;
      dirty_.push_back(site);
    }
}

void Simplifier::remove(const Evaluation& evaluation) {
  const std::size_t before = state_.connectivity.face_count();
  for (RemovalRecord& record : removal_) {
    claim_ring(record);
    remove_vertex(state_.connectivity, record);
    if (evaluator_.measures_distances()) carry_points(state_, record);
    carry_lines(state_, record);
  }
  bounds_.add(removal_);
  builder_.add(removal_, evaluation.curvature_error);
  note_charge(evaluation.cost);
  const Index vertex = removal_.front().vertex;
  pieces_.lose_faces(pieces_.piece_of(vertex), before - state_.connectivity.face_count());
  cost_[state_.connectivity.site(vertex)] = kIllegal;
}

void Simplifier::try_remove(Index vertex) {
  if (!ring_is_free(vertex)) return;
  Evaluation evaluation = evaluator_.evaluate(vertex, removal_, choice_[vertex]);
  // Its surroundings may have changed since it was ranked.
  verdict_[vertex] = evaluation.verdict;
  if (evaluation.verdict != Verdict::Legal || evaluation.curvature_error > options_.stop.max_curvature_error) {
    cost_[vertex] = kIllegal;
    return;
  }
  evaluation.cost = static_cast<double>(cost_[vertex]);  // as ranked, importance included
  remove(evaluation);
}

void Simplifier::note_charge(double cost) {
  const double length = options_.metric == Metric::Hybrid ? std::pow(cost, 1 / kDistanceExponent) : cost;
  charge_.push_back(std::max(static_cast<float>(length), charge_.empty() ? 0.0F : charge_.back()));
}

/// The charges by position, coarse to fine.
std::vector<float> Simplifier::charges() const {
  std::vector<float> result(charge_.rbegin(), charge_.rend());
  result.push_back(0);
  return result;
}

bool Simplifier::target_met() {
  if (state_.connectivity.face_count() <= options_.stop.min_faces) {
    stop_reason_ = StopReason::Faces;
    return true;
  }
  return false;
}

/// Looks anew at what lies around this round's removals.
void Simplifier::update_dirty() {
  const Connectivity& mesh = state_.connectivity;
  for (const Index site : dirty_)
    for (Index copy = site;;) {
      state_.curvature[copy] = vertex_curvature(state_.mesh, mesh, copy);
      copy = mesh.next_copy(copy);
      if (copy == site) break;
    }
  for (const Index site : dirty_) {
    stale_[site] = 1;
    // It may be legal now; and on flat sides costs fall, too, as what has been in the way goes.
    if (cost_[site] == kIllegal || limit_ == 0) evaluate(site);
  }
}

/// Removes the candidates whose rings do not meet, and pieces that cost no more; false where nothing is left to try.
bool Simplifier::run_round() {
  dirty_.clear();
  const bool any_left = choose_candidates();
  for (const Index vertex : candidates_) {
    if (target_met()) break;
    try_remove(vertex);
  }
  update_dirty();
  builder_.end_round();
  ++round_;
  // Where nothing could go, costs have risen or candidates have dropped out: only an empty list ends the run.
  return remove_pieces(!any_left) || any_left;
}

/// Whether only the limit on angles keeps a vertex; of several copies the first stands for all.
bool Simplifier::is_kept_by_turning(Index vertex) const {
  const Connectivity& mesh = state_.connectivity;
  return verdict_[vertex] == Verdict::Turn && mesh.has_vertex(vertex) && mesh.site(vertex) == vertex;
}

/// Lets faces turn further, and looks anew at the vertices that this kept. Returns whether there was further to go.
bool Simplifier::relax_angles(bool beyond_right_angles) {
  if (!evaluator_.relax_angles(beyond_right_angles)) return false;
  for (Index v = 0; v < cost_.size(); ++v)
    if (is_kept_by_turning(v)) evaluate(v);
  return true;
}

/// Works out what each piece costs that vanishes: its width for every point it stands for, and the curvature that goes
/// with it.
void Simplifier::price_pieces() {
  piece_moves_.assign(pieces_.count(), 1);
  for (Index piece = 0; piece < pieces_.count(); ++piece) {
    float error = 0;
    float importance = options_.importance.empty() ? 1.0F : 0.0F;
    bool stays = false;
    for (const Index v : pieces_.vertices(piece)) {
      error = std::max(error, std::abs(state_.original_curvature[v]));
      if (!options_.importance.empty()) importance = std::max(importance, options_.importance[v]);
      stays = stays || is_locked(v);
    }
    const double charge = pieces_.charge(state_.mesh, piece);
    const bool is_hybrid = options_.metric == Metric::Hybrid;
    double cost = is_hybrid ? hybrid_cost(charge, static_cast<double>(error)) : static_cast<double>(error);
    cost *= static_cast<double>(importance);
    stays = stays || error > options_.stop.max_curvature_error;
    piece_cost_.push_back(stays ? kIllegal : static_cast<float>(cost));
    piece_error_.push_back(error);
  }
}

/// The pieces to go, cheapest first: those within the round's limit that are small or cannot be simplified further, or
/// any where nothing else can be removed.
std::vector<Index> Simplifier::choose_pieces(bool stuck) {
  std::vector<Index> chosen;
  for (Index piece = 0; piece < pieces_.count(); ++piece) {
    if (pieces_.face_count(piece) == 0 || piece_cost_[piece] == kIllegal) continue;
    const bool used_up = pieces_.face_count(piece) <= kSmallPiece || piece_moves_[piece] == 0;
    if (stuck || (used_up && piece_cost_[piece] <= limit_)) chosen.push_back(piece);
  }
  std::sort(chosen.begin(), chosen.end(), [&](Index a, Index b) {
    return piece_cost_[a] != piece_cost_[b] ? piece_cost_[a] < piece_cost_[b] : a < b;
  });
  return chosen;
}

bool Simplifier::remove_pieces(bool stuck) {
  bool any = false;
  for (const Index piece : choose_pieces(stuck)) {
    if (target_met() || (pieces_.left() == 1 && !options_.vanish)) break;
    remove_piece(piece);
    any = true;
  }
  return any;
}

void Simplifier::remove_piece(Index piece) {
  Index seed = kNoIndex;
  for (const Index v : pieces_.vertices(piece)) {
    cost_[v] = kIllegal;
    if (seed == kNoIndex && state_.connectivity.has_vertex(v)) seed = v;
  }
  const std::vector<RemovalRecord> records = remove_component(state_.connectivity, pieces_.vertices(piece));
  pieces_.vanish(piece);
  const Index near = vertex_left_near(seed, piece);
  if (near == kNoIndex) {
    bounds_.add_last();
  } else {
    double reach = 0;
    for (const RemovalRecord& record : records)
      reach = std::max(reach, length(Vec3(state_.mesh.positions[record.vertex]) - Vec3(state_.mesh.positions[near])));
    bounds_.add_vanished(records, face_of_corner(state_.connectivity.corner_at(near)), reach);
  }
  // One after the other: copies of a vertex make one record, and each record stands in a round of its own.
  const auto site = [&](std::size_t i) { return state_.connectivity.site(records[i].vertex); };
  for (std::size_t i = 0, j = 0; i < records.size(); i = j) {
    while (j < records.size() && site(j) == site(i)) ++j;
    builder_.add(std::span(records).subspan(i, j - i), static_cast<double>(piece_error_[piece]));
    bounds_.repeat();
    builder_.end_round();
    note_charge(static_cast<double>(piece_cost_[piece]));
  }
}

/// A vertex that is left near another: the nearest of some, going both ways along the curve in which vertices stand.
Index Simplifier::vertex_left_near(Index vertex, Index piece) const {
  Index best = kNoIndex;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](Index v) {
    if (!state_.connectivity.has_vertex(v) || pieces_.piece_of(v) == piece) return false;
    const double distance = squared_length(Vec3(state_.mesh.positions[v]) - Vec3(state_.mesh.positions[vertex]));
    if (distance < least) least = distance, best = v;
    return true;
  };
  int found = 0;
  for (Index v = vertex; v-- > 0 && found < kNearCandidates;) found += consider(v) ? 1 : 0;
  found = 0;
  for (Index v = vertex + 1; v < state_.mesh.vertex_count() && found < kNearCandidates; ++v)
    found += consider(v) ? 1 : 0;
  return best;
}

BlockedCounts Simplifier::count_blocked() const {
  BlockedCounts blocked;
  for (Index v = 0; v < verdict_.size(); ++v) {
    if (!state_.connectivity.has_vertex(v) || state_.connectivity.site(v) != v) continue;
    switch (verdict_[v]) {
      case Verdict::Legal:
        ++blocked.error;
        break;
      case Verdict::Locked:
        ++blocked.locked;
        break;
      case Verdict::Turn:
        ++blocked.flip;
        break;
      case Verdict::Shape:
        ++blocked.shape;
        break;
      case Verdict::Texture:
        ++blocked.texture;
        break;
      case Verdict::Link:
        ++blocked.link;
        break;
      case Verdict::Ring:
        ++blocked.ring;
        break;
    }
  }
  return blocked;
}

SimplifyResult Simplifier::run() {
  prepare();
  const double full_faces = static_cast<double>(state_.connectivity.face_count());
  while (!target_met()) {
    if (!run_round() && !relax_angles(true)) break;
    bounds_.end_round(state_.connectivity);
    if (bounds_.current() > options_.stop.max_deviation) {
      stop_reason_ = StopReason::Deviation;
      break;
    }
    const double left = static_cast<double>(state_.connectivity.face_count()) / full_faces;
    if (options_.progress && !options_.progress(1 - left)) {
      stop_reason_ = StopReason::Cancelled;
      break;
    }
  }
  SimplifyResult result;
  result.blocked = count_blocked();
  if (stop_reason_ == StopReason::Stuck && result.blocked.error > 0) stop_reason_ = StopReason::CurvatureError;
  bounds_.stop_measuring();
  result.stop_reason = stop_reason_;
  result.evaluation_count = evaluation_count_;
  result.charge = charges();
  result.locked = std::move(locked_);
  result.mesh = builder_.finish(bounds_.bounds());
  return result;
}

}  // namespace

BlockedCounts operator+(const BlockedCounts& a, const BlockedCounts& b) {
  return {a.locked + b.locked, a.flip + b.flip,       a.link + b.link,  a.shape + b.shape,
          a.ring + b.ring,     a.texture + b.texture, a.error + b.error};
}

Result<SimplifyResult> simplify(const Mesh& mesh, const SimplifyOptions& options) {
  LODESTONE_CHECK(validate(mesh));
  if (!options.importance.empty() && options.importance.size() != mesh.vertex_count())
    return fail(ErrorCode::InvalidArgument,
                text("importance has ", options.importance.size(), " values for ", mesh.vertex_count(), " vertices"));
  std::vector<Index> source_vertex;
  const Mesh sorted = in_spatial_order(mesh, source_vertex);
  LODESTONE_TRY(Connectivity connectivity, Connectivity::build(sorted));
  mark_creases(sorted, options, connectivity);
  SimplifyOptions local = options;
  for (std::size_t v = 0; v < local.importance.size(); ++v) local.importance[v] = options.importance[source_vertex[v]];
  SimplifyResult result = Simplifier(sorted, std::move(connectivity), local).run();
  const std::vector<std::uint8_t> locked = result.locked;
  for (std::size_t v = 0; v < locked.size(); ++v) result.locked[source_vertex[v]] = locked[v];
  return result;
}

}  // namespace lodestone

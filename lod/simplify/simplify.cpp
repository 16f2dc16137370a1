// Removal in rounds: each round takes the cheapest share of all vertices in order of (cost, number) and removes those
// whose rings do not meet. Within a round records commute, which keeps the order of work, and the number of threads,
// out of the result. Pieces that are nearly used up vanish as a whole once that costs no more than the round's
// removals. Costs: see removal_evaluator.cpp. Deviation bounds: see deviation_bounds.cpp.

#include <lodestone/lod/simplify.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <lodestone/core/detail/index_limit.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>
#include <lodestone/core/validate.h>

#include "simplify/creases.h"
#include "simplify/dense_round.h"
#include "simplify/deviation_bounds.h"
#include "simplify/evaluator_pool.h"
#include "simplify/locks.h"
#include "simplify/pieces.h"
#include "simplify/point_carrier.h"
#include "simplify/record_builder.h"
#include "simplify/site_walk.h"
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

// Removals that are worked out at once, and vertices that one thread evaluates at once.
constexpr std::size_t kBatch = 2048;
constexpr std::size_t kChunk = 64;

// Of the work: the first evaluation of all vertices. The rest is told by the faces that have gone.
constexpr double kFirstShare = 0.2;

// Records together have about as many corners as the mesh, and are numbered likewise: twice as many have room.
constexpr std::size_t kMostCorners = kNoIndex / 2;

constexpr float kIllegal = std::numeric_limits<float>::infinity();

/// A removal of this round: the vertex chosen, and what was found and done about it.
struct PlannedRemoval {
  Index vertex = kNoIndex;
  Removal records;
  Evaluation evaluation;
  std::vector<double> curvature;     // K̄ of the ring after it, where the evaluator knows it; else empty
  std::vector<double> displacement;  // of each record
  std::size_t face_count = 0;        // that it took
};

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, Connectivity connectivity, const SimplifyOptions& options)
      : options_(options),
        state_{mesh, std::move(connectivity), CarriedPoints(mesh), {}, {}, {}, {}},
        evaluators_(state_, options_),
        builder_(mesh, state_.connectivity),
        bounds_(mesh, options.measure_step, options.progress),
        locked_(find_locked(state_.connectivity, options_)),
        pieces_(mesh, state_.connectivity),
        rounds_(options.progress.part(1 - kFirstShare)),
        within_round_(options.progress.part(0)) {}

  SimplifyResult run();

 private:
  void prepare();
  bool is_standing(Index vertex) const {
    return state_.connectivity.has_vertex(vertex) && state_.connectivity.site(vertex) == vertex;
  }
  bool is_locked(Index vertex) const { return !locked_.empty() && locked_[vertex] != 0; }
  void evaluate(std::span<const Index> vertices, const Progress& progress);
  void evaluate(RemovalEvaluator& evaluator, Index vertex);
  bool choose_candidates();
  void keep_cheapest(std::size_t count);
  std::vector<std::uint64_t> rank(std::span<const Index> vertices) const;
  void drop_dearer(std::vector<Index>& vertices);
  void look_anew();
  void choose_dense();
  void pick_round();
  bool run_round();
  std::size_t plan_batch(std::size_t candidate);
  void describe(RemovalEvaluator& evaluator, PlannedRemoval& planned);
  bool remove_batch();
  void remove(PlannedRemoval& planned);
  void follow_up(PointCarrier& carrier, PlannedRemoval& planned);
  void account_for(PlannedRemoval& planned);
  bool claim_ring(Index vertex);
  void update_dirty();
  bool is_kept_by_turning(Index vertex) const;
  bool relax_angles(bool beyond_right_angles);
  bool is_over();
  bool is_beyond_deviation();
  void tell() const;
  void note_charge(double cost);
  void stop_removing();
  std::vector<float> charges() const;

  void price_pieces();
  bool remove_pieces(bool stuck);
  std::vector<Index> choose_pieces(bool stuck);
  void remove_piece(Index piece);
  Index vertex_left_near(Index vertex, Index piece) const;

  BlockedCounts count_blocked() const;

  SimplifyOptions options_;
  SimplifyState state_;
  EvaluatorPool evaluators_;
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
  std::vector<Index> standing_;      // sites that are left, ascending, and some that have gone
  std::vector<Index> candidates_;
  DenseRound dense_;
  std::vector<Index> within_;     // its limit: candidates of a dense round
  std::vector<Index> postponed_;  // of a dense round: whose turn is next
  std::vector<Index> claimed_;    // by vertex: the round that last claimed it, + 1
  std::vector<Index> dirty_;
  std::vector<Index> bent_;  // vertices around removals after which K̄ is not known yet
  std::vector<Index> looked_at_;
  std::vector<PlannedRemoval> batch_;
  std::size_t batch_size_ = 0;
  std::vector<std::size_t> along_curve_;  // the batch's removals in the order of their vertices
  Index round_ = 0;
  Star star_;
  StopReason stop_reason_ = StopReason::Stuck;
  Progress rounds_;        // told by the faces that have gone
  Progress within_round_;  // hears
  std::size_t evaluation_count_ = 0;
};

void Simplifier::prepare() {
  const std::size_t count = state_.mesh.vertex_count();
  gather_curvature(state_, options_);
  for (Index v = 0; v < options_.importance.size(); ++v) {
    float& of_all = options_.importance[state_.connectivity.site(v)];
    of_all = std::max(of_all, options_.importance[v]);
  }
  cost_.assign(count, kIllegal);
  choice_.assign(count, {kNoChoice, kNoChoice});
  stale_.assign(count, 0);
  verdict_.assign(count, Verdict::Locked);
  claimed_.assign(count, 0);
  standing_.reserve(count);
  for (Index v = 0; v < count; ++v)
    if (is_standing(v)) standing_.push_back(v);
  candidates_.reserve(standing_.size());
  charge_.reserve(standing_.size());
  evaluate(standing_, options_.progress.part(kFirstShare));
  price_pieces();
}

void Simplifier::evaluate(std::span<const Index> vertices, const Progress& progress) {
  evaluators_.for_each(vertices.size(), kChunk, progress,
                       [&](RemovalEvaluator& evaluator, std::size_t i) { evaluate(evaluator, vertices[i]); });
  evaluation_count_ += vertices.size();
}

void Simplifier::evaluate(RemovalEvaluator& evaluator, Index vertex) {
  choice_[vertex] = {kNoChoice, kNoChoice};
  if (is_locked(vertex)) return;  // as `prepare` left it
  Evaluation evaluation = evaluator.evaluate(vertex, choice_[vertex]);
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
  std::erase_if(standing_, [&](Index v) { return !state_.connectivity.has_vertex(v); });
  for (const Index v : standing_) {
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
  if (options_.dense_rounds > 0) {
    choose_dense();
    return true;
  }
  const double narrow = is_hybrid ? kNarrowShare : kNarrowPureShare;
  const double share = candidates_.size() < kNarrowBelow ? narrow : kWideShare;
  keep_cheapest(static_cast<std::size_t>(std::ceil(share * static_cast<double>(candidates_.size()))));
  return true;
}

/// Leaves so many of `candidates_`, or what of them is still as cheap, in order of (cost, number).
void Simplifier::keep_cheapest(std::size_t count) {
  std::vector<std::uint64_t> ranked = rank(candidates_);
  const auto last = ranked.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(ranked.begin(), last, ranked.end());
  const auto vertex = [](std::uint64_t r) { return static_cast<Index>(r); };
  const bool any_free = std::any_of(ranked.begin(), last, [&](std::uint64_t r) { return cost_[vertex(r)] == 0; });
  limit_ = any_free ? 0 : cost_[vertex(*last)];
  candidates_.resize(count);
  std::transform(ranked.begin(), last + 1, candidates_.begin(), vertex);
  drop_dearer(candidates_);
  ranked = rank(candidates_);
  std::sort(ranked.begin(), ranked.end());
  std::transform(ranked.begin(), ranked.end(), candidates_.begin(), vertex);
}

/// Returns numbers that order the vertices by (cost, number), since floats of 0 and more are in the order of their
/// bits.
std::vector<std::uint64_t> Simplifier::rank(std::span<const Index> vertices) const {
  std::vector<std::uint64_t> ranked;
  ranked.reserve(vertices.size());
  for (const Index v : vertices) ranked.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(cost_[v])} << 32 | v);
  return ranked;
}

/// Evaluates anew what is stale, and leaves out what costs more than the limit.
void Simplifier::drop_dearer(std::vector<Index>& vertices) {
  looked_at_.clear();
  for (const Index v : vertices)
    if (stale_[v] != 0) looked_at_.push_back(v);
  look_anew();
  std::erase_if(vertices, [&](Index v) { return cost_[v] > limit_; });
}

/// Evaluates `looked_at_`, in the order of the curve: what is evaluated next then lies where the last was.
void Simplifier::look_anew() {
  std::sort(looked_at_.begin(), looked_at_.end());
  evaluate(looked_at_, within_round_);
}

/// Replaces `candidates_`, all that can go, by those picked for a dense round whose turn has not come; rings that meet
/// take turns. Where none is left, a new round is picked.
void Simplifier::choose_dense() {
  const auto drop_illegal = [&](std::vector<Index>& vertices) {
    std::erase_if(vertices, [&](Index v) { return !state_.connectivity.has_vertex(v) || cost_[v] == kIllegal; });
  };
  for (;;) {
    std::vector<Index> turn = std::exchange(postponed_, {});
    drop_illegal(turn);
    if (!turn.empty()) {
      candidates_ = std::move(turn);
      return;
    }
    drop_illegal(candidates_);
    if (candidates_.empty()) return;
    pick_round();
  }
}

/// Picks a round among `candidates_` and postpones all of it; none where costs have risen above what they were.
void Simplifier::pick_round() {
  const auto cheaper = [&](Index a, Index b) { return cost_[a] < cost_[b]; };
  const auto middle = candidates_.begin() + static_cast<std::ptrdiff_t>(candidates_.size() / 2);
  std::nth_element(candidates_.begin(), middle, candidates_.end(), cheaper);
  const float cheapest = cost_[*std::min_element(candidates_.begin(), candidates_.end(), cheaper)];
  limit_ = std::max(cheapest, static_cast<float>(static_cast<double>(cost_[*middle]) * options_.dense_rounds));
  within_.clear();
  for (const Index v : candidates_)
    if (cost_[v] <= limit_) within_.push_back(v);
  drop_dearer(within_);
  postponed_ = dense_.pick(state_.connectivity, within_, cost_);
}

/// Claims a vertex, its copies and their rings for its removal, unless one of them is claimed in this round.
bool Simplifier::claim_ring(Index vertex) {
  const Connectivity& mesh = state_.connectivity;
  looked_at_.clear();
  for_each_neighbour(mesh, vertex, [&](Index, Index neighbour) { looked_at_.push_back(mesh.site(neighbour)); });
  looked_at_.push_back(vertex);
  for (const Index site : looked_at_)
    if (claimed_[site] == round_ + 1) return false;
  for (const Index site : looked_at_) claimed_[site] = round_ + 1;
  return true;
}

/// Plans the removals of candidates, from one on, whose rings do not meet; returns the first candidate not looked at.
std::size_t Simplifier::plan_batch(std::size_t candidate) {
  batch_size_ = 0;
  for (; candidate < candidates_.size() && batch_size_ < kBatch; ++candidate) {
    const Index vertex = candidates_[candidate];
    if (!claim_ring(vertex)) {
      if (options_.dense_rounds > 0) postponed_.push_back(vertex);
      continue;
    }
    if (batch_size_ == batch_.size()) batch_.emplace_back();
    batch_[batch_size_++].vertex = vertex;
  }
  along_curve_.resize(batch_size_);
  std::iota(along_curve_.begin(), along_curve_.end(), std::size_t{0});
  std::sort(along_curve_.begin(), along_curve_.end(),
            [&](std::size_t a, std::size_t b) { return batch_[a].vertex < batch_[b].vertex; });
  evaluators_.for_each(batch_size_, kChunk, within_round_, [&](RemovalEvaluator& evaluator, std::size_t i) {
    describe(evaluator, batch_[along_curve_[i]]);
  });
  return candidate;
}

/// Looks at a removal again: what lies around its ring may have changed since it was ranked.
void Simplifier::describe(RemovalEvaluator& evaluator, PlannedRemoval& planned) {
  const Index vertex = planned.vertex;
  planned.evaluation = evaluator.describe(vertex, choice_[vertex], planned.records, planned.curvature);
  planned.evaluation.cost = static_cast<double>(cost_[vertex]);  // as ranked, importance included
  verdict_[vertex] = planned.evaluation.verdict;
  if (!rejects(planned.evaluation.verdict) && planned.evaluation.curvature_error > options_.stop.max_curvature_error)
    planned.evaluation.verdict = Verdict::Locked;
  if (rejects(planned.evaluation.verdict)) cost_[vertex] = kIllegal;
}

/// Does the removals planned; false where the run was over before all were.
bool Simplifier::remove_batch() {
  std::size_t done = 0;
  for (; done < batch_size_ && !is_over(); ++done) remove(batch_[done]);
  for_each_chunk(batch_size_, kChunk, [&](std::size_t begin, std::size_t end) {
    PointCarrier carrier(state_);
    for (std::size_t i = begin; i < end; ++i)
      if (along_curve_[i] < done) follow_up(carrier, batch_[along_curve_[i]]);
  });
  for (std::size_t i = 0; i < done; ++i) account_for(batch_[i]);
  return done == batch_size_;
}

void Simplifier::remove(PlannedRemoval& planned) {
  if (rejects(planned.evaluation.verdict)) return;
  const std::size_t before = state_.connectivity.face_count();
  for (RemovalRecord& record : planned.records) {
    remove_vertex(state_.connectivity, record);
    carry_lines(state_, record);
  }
  planned.face_count = before - state_.connectivity.face_count();
}

/// What one removal does by itself, and nowhere but in its own star.
void Simplifier::follow_up(PointCarrier& carrier, PlannedRemoval& planned) {
  if (rejects(planned.evaluation.verdict)) return;
  if (measured_triangulations(options_) > 0)
    for (const RemovalRecord& record : planned.records) carrier.carry(record);
  keep_curvature(state_, planned.records, planned.curvature);
  bounds_.displacements(planned.records, planned.displacement);
}

void Simplifier::account_for(PlannedRemoval& planned) {
  if (rejects(planned.evaluation.verdict)) return;
  const Connectivity& mesh = state_.connectivity;
  const auto add_once = [](std::vector<Index>& list, std::size_t begin, Index entry) {
    const auto first = list.begin() + static_cast<std::ptrdiff_t>(begin);
    if (std::find(first, list.end(), entry) == list.end()) list.push_back(entry);
  };
  const std::size_t first_dirty = dirty_.size();
  const std::size_t first_bent = bent_.size();
  for (const RemovalRecord& record : planned.records)
    for (const SectorPatch& sector : record.sectors)
      for (const Index wedge : sector.polygon) {
        const Index vertex = mesh.vertex_of_wedge(wedge);
        add_once(dirty_, first_dirty, mesh.site(vertex));
        if (planned.curvature.empty()) add_once(bent_, first_bent, vertex);
      }
  bounds_.add(planned.records, planned.displacement);
  builder_.add(planned.records, planned.evaluation.curvature_error);
  note_charge(planned.evaluation.cost);
  const Index vertex = planned.vertex;
  pieces_.lose_faces(pieces_.piece_of(vertex), planned.face_count);
  cost_[vertex] = kIllegal;
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

bool Simplifier::is_over() {
  if (options_.progress.is_cancelled()) return true;
  if (state_.connectivity.face_count() <= options_.stop.min_faces) {
    stop_reason_ = StopReason::Faces;
    return true;
  }
  return false;
}

/// Waits for a measurement only where its result may end the run.
bool Simplifier::is_beyond_deviation() {
  const double most = options_.stop.max_deviation;
  return most < std::numeric_limits<double>::infinity() && bounds_.current() > most;
}

void Simplifier::tell() const {
  rounds_.reach(1 -
                static_cast<double>(state_.connectivity.face_count()) / static_cast<double>(state_.mesh.face_count()));
}

/// Looks anew at what lies around this round's removals.
void Simplifier::update_dirty() {
  for_each_chunk(bent_.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) update_curvature(state_, options_, bent_[i]);
  });
  looked_at_.clear();
  for (const Index site : dirty_) {
    // It may be legal now; and on flat sides costs fall, too, as what has been in the way goes.
    if (cost_[site] == kIllegal || limit_ == 0) looked_at_.push_back(site);
    stale_[site] = 1;
  }
  look_anew();
}

/// Removes the candidates whose rings do not meet, and pieces that cost no more; false where nothing is left to try.
bool Simplifier::run_round() {
  dirty_.clear();
  bent_.clear();
  const bool any_left = choose_candidates();
  for (std::size_t candidate = 0; candidate < candidates_.size();) {
    candidate = plan_batch(candidate);
    if (!remove_batch()) break;
    tell();
  }
  update_dirty();
  builder_.end_round();
  ++round_;
  // Where nothing could go, costs have risen or candidates have dropped out: only an empty list ends the run.
  return remove_pieces(!any_left) || any_left;
}

/// Whether only the limit on angles keeps a vertex; of several copies the first stands for all.
bool Simplifier::is_kept_by_turning(Index vertex) const {
  return verdict_[vertex] == Verdict::Turn && is_standing(vertex);
}

/// Lets faces turn further, and looks anew at the vertices that this kept. Returns whether there was further to go.
bool Simplifier::relax_angles(bool beyond_right_angles) {
  if (!evaluators_.relax_angles(beyond_right_angles)) return false;
  std::vector<Index> kept;
  for (const Index v : standing_)
    if (is_kept_by_turning(v)) kept.push_back(v);
  evaluate(kept, within_round_);
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
    if (is_over() || (pieces_.left() == 1 && !options_.vanish)) break;
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

/// Frees what only further removals would need: the records are as large again while they become the result.
void Simplifier::stop_removing() {
  const auto free = [](auto&... all) { ((all = std::remove_reference_t<decltype(all)>()), ...); };
  evaluators_.stop();
  state_.points = CarriedPoints(Mesh());
  free(state_.lines, state_.gaussian, state_.curvature, state_.original_curvature);
  free(cost_, verdict_, choice_, stale_, standing_, candidates_, claimed_, dirty_, bent_, looked_at_, batch_,
       along_curve_);
  free(dense_, within_, postponed_);
}

BlockedCounts Simplifier::count_blocked() const {
  BlockedCounts blocked;
  for (Index v = 0; v < verdict_.size(); ++v) {
    if (!is_standing(v)) continue;
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
  while (!is_over()) {
    if (!run_round() && !relax_angles(true)) break;
    if (options_.progress.is_cancelled()) break;
    bounds_.end_round(state_.connectivity);
    if (is_beyond_deviation()) {
      stop_reason_ = StopReason::Deviation;
      break;
    }
    tell();
  }
  const std::vector<float> deviation = bounds_.take_bounds();
  SimplifyResult result;
  result.blocked = count_blocked();
  if (options_.progress.is_cancelled()) stop_reason_ = StopReason::Cancelled;
  if (stop_reason_ == StopReason::Stuck && result.blocked.error > 0) stop_reason_ = StopReason::CurvatureError;
  stop_removing();
  result.stop_reason = stop_reason_;
  result.evaluation_count = evaluation_count_;
  result.charge = charges();
  result.locked = std::move(locked_);
  result.mesh = builder_.finish(deviation);
  options_.progress.reach(1);
  return result;
}

}  // namespace

BlockedCounts operator+(const BlockedCounts& a, const BlockedCounts& b) {
  return {a.locked + b.locked, a.flip + b.flip,       a.link + b.link,  a.shape + b.shape,
          a.ring + b.ring,     a.texture + b.texture, a.error + b.error};
}

Result<SimplifyResult> simplify(const Mesh& mesh, const SimplifyOptions& options) {
  LODESTONE_CHECK(validate(mesh));
  LODESTONE_CHECK(check_index_limit("corners of a mesh with records", mesh.corner_wedge.size(), kMostCorners));
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

// Removal in rounds: each round takes the cheapest share of all vertices in order of (cost, number) and removes those
// whose rings do not meet. Within a round records commute, which keeps the order of work out of the result.
// Costs: see removal_evaluator.cpp. Deviation bounds: see deviation_bounds.cpp.

#include <lodestone/lod/simplify.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lodestone/core/validate.h>

#include "deviation_bounds.h"
#include "record_builder.h"
#include "removal_evaluator.h"
#include "spatial_order.h"

namespace lodestone {
namespace {

using namespace detail;

// Large meshes lose nothing by wide rounds; near the end every removal counts.
constexpr double kWideShare = 0.25;
constexpr double kNarrowShare = 0.05;
constexpr double kNarrowPureShare = 0.02;  // curvature alone leaves many ties, and their order matters
constexpr std::size_t kNarrowBelow = 8000;

constexpr float kIllegal = std::numeric_limits<float>::infinity();

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, Connectivity connectivity, const SimplifyOptions& options)
      : options_(options),
        state_{mesh, std::move(connectivity), CarriedPoints(mesh), {}, {}, {}},
        evaluator_(state_, options_),
        builder_(mesh),
        bounds_(mesh, options.measure_step) {}

  SimplifyResult run();

 private:
  void prepare();
  void evaluate(Index vertex);
  bool choose_candidates();
  bool run_round();
  void try_remove(Index vertex);
  void remove(RemovalRecord& record, const Evaluation& evaluation);
  bool ring_is_free(Index vertex);
  void claim_ring(const RemovalRecord& record);
  bool target_met();
  bool held_by_curvature() const;
  BlockedCounts count_blocked() const;

  SimplifyOptions options_;
  SimplifyState state_;
  RemovalEvaluator evaluator_;
  RecordBuilder builder_;
  DeviationBounds bounds_;

  std::vector<float> cost_;
  std::vector<Verdict> verdict_;
  std::vector<Choice> choice_;
  std::vector<std::uint8_t> stale_;  // by vertex: whether its surroundings have changed since it was evaluated
  std::vector<Index> candidates_;
  std::vector<Index> claimed_;  // by vertex: the round that last claimed it, + 1
  std::vector<Index> dirty_;
  Index round_ = 0;
  RemovalRecord record_;
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
  cost_.assign(count, kIllegal);
  choice_.assign(count, {kNoChoice, kNoChoice});
  stale_.assign(count, 0);
  verdict_.assign(count, Verdict::Locked);
  claimed_.assign(count, 0);
  for (Index v = 0; v < count; ++v)
    if (state_.connectivity.has_vertex(v)) evaluate(v);
}

void Simplifier::evaluate(Index vertex) {
  choice_[vertex] = {kNoChoice, kNoChoice};
  const Evaluation evaluation = evaluator_.evaluate(vertex, record_, choice_[vertex]);
  ++evaluation_count_;
  stale_[vertex] = 0;
  verdict_[vertex] = evaluation.verdict;
  const bool within = evaluation.curvature_error <= options_.stop.max_curvature_error;
  cost_[vertex] = evaluation.verdict == Verdict::Legal && within ? static_cast<float>(evaluation.cost) : kIllegal;
}

/// Fills `candidates_` with the cheapest share of the vertices, in order of (cost, number).
///
/// Costs mostly rise, so a vertex whose surroundings have changed keeps its old cost until that brings it in here; then
/// it is evaluated anew, and stays if it is still as cheap as the rest. Returns whether any vertex was left to look at.
bool Simplifier::choose_candidates() {
  candidates_.clear();
  for (Index v = 0; v < cost_.size(); ++v)
    if (cost_[v] < kIllegal) candidates_.push_back(v);
  if (candidates_.empty()) return false;
  const double narrow = options_.metric == Metric::Hybrid ? kNarrowShare : kNarrowPureShare;
  const double share = candidates_.size() < kNarrowBelow ? narrow : kWideShare;
  const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(candidates_.size())));
  const auto cheaper = [&](Index a, Index b) { return cost_[a] != cost_[b] ? cost_[a] < cost_[b] : a < b; };
  const auto last = candidates_.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(candidates_.begin(), last, candidates_.end(), cheaper);
  const float limit = cost_[*last];
  candidates_.resize(count);
  for (const Index v : candidates_)
    if (stale_[v] != 0) evaluate(v);
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), [&](Index v) { return cost_[v] > limit; }),
                    candidates_.end());
  std::sort(candidates_.begin(), candidates_.end(), cheaper);
  return true;
}

bool Simplifier::ring_is_free(Index vertex) {
  if (claimed_[vertex] == round_ + 1) return false;
  state_.connectivity.gather_star(vertex, star_);
  return std::none_of(star_.corners.begin(), star_.corners.end(), [&](Index corner) {
    return claimed_[state_.connectivity.vertex(next_corner(corner))] == round_ + 1 ||
           claimed_[state_.connectivity.vertex(previous_corner(corner))] == round_ + 1;
  });
}

void Simplifier::claim_ring(const RemovalRecord& record) {
  claimed_[record.vertex] = round_ + 1;
  for (const SectorPatch& sector : record.sectors)
    for (const Index wedge : sector.polygon) {
      const Index v = state_.connectivity.vertex_of_wedge(wedge);
      if (claimed_[v] == round_ + 1) continue;
      claimed_[v] = round_ + 1;
      dirty_.push_back(v);
    }
}

void Simplifier::remove(RemovalRecord& record, const Evaluation& evaluation) {
  claim_ring(record);
  bounds_.add(record);
  remove_vertex(state_.connectivity, record);
  carry_memory(state_, record);
  builder_.add(record, evaluation.curvature_error);
  cost_[record.vertex] = kIllegal;
}

void Simplifier::try_remove(Index vertex) {
  if (!ring_is_free(vertex)) return;
  const Evaluation evaluation = evaluator_.evaluate(vertex, record_, choice_[vertex]);
  // Its surroundings may have changed since it was ranked.
  verdict_[vertex] = evaluation.verdict;
  if (evaluation.verdict != Verdict::Legal || evaluation.curvature_error > options_.stop.max_curvature_error) {
    cost_[vertex] = kIllegal;
    return;
  }
  remove(record_, evaluation);
}

bool Simplifier::target_met() {
  if (state_.connectivity.face_count() <= options_.stop.min_faces) {
    stop_reason_ = StopReason::Faces;
    return true;
  }
  return false;
}

/// Removes the candidates whose rings do not meet; false where none is left to try.
bool Simplifier::run_round() {
  dirty_.clear();
  const bool any_left = choose_candidates();
  for (const Index vertex : candidates_) {
    if (target_met()) break;
    try_remove(vertex);
  }
  for (const Index v : dirty_) state_.curvature[v] = vertex_curvature(state_.mesh, state_.connectivity, VertexId{v});
  for (const Index v : dirty_) {
    stale_[v] = 1;
    if (cost_[v] == kIllegal) evaluate(v);  // it may be legal now
  }
  builder_.end_round();
  ++round_;
  // Where nothing could go, costs have risen or candidates have dropped out: only an empty list ends the run.
  return any_left;
}

/// Whether a legal removal is left that only the limit on the curvature error forbids.
bool Simplifier::held_by_curvature() const {
  for (Index v = 0; v < verdict_.size(); ++v)
    if (state_.connectivity.has_vertex(v) && verdict_[v] == Verdict::Legal) return true;
  return false;
}

BlockedCounts Simplifier::count_blocked() const {
  BlockedCounts blocked;
  for (Index v = 0; v < verdict_.size(); ++v) {
    if (!state_.connectivity.has_vertex(v)) continue;
    switch (verdict_[v]) {
      case Verdict::Legal:
        break;
      case Verdict::Locked:
        ++blocked.locked;
        break;
      case Verdict::Flip:
        ++blocked.flip;
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
    if (!run_round()) break;
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
  if (stop_reason_ == StopReason::Stuck && held_by_curvature()) stop_reason_ = StopReason::CurvatureError;
  bounds_.stop_measuring();
  SimplifyResult result;
  result.stop_reason = stop_reason_;
  result.blocked = count_blocked();
  result.evaluation_count = evaluation_count_;
  result.mesh = builder_.finish(state_.connectivity, bounds_.bounds());
  return result;
}

}  // namespace

Result<SimplifyResult> simplify(const Mesh& mesh, const SimplifyOptions& options) {
  if (auto valid = validate(mesh); !valid) return tl::unexpected(valid.error());
  const Mesh sorted = in_spatial_order(mesh);
  auto connectivity = Connectivity::build(sorted);
  if (!connectivity) return tl::unexpected(connectivity.error());
  return Simplifier(sorted, std::move(*connectivity), options).run();
}

}  // namespace lodestone

// Removal of the copies of a vertex at which sheets meet or lie on one another. A vertex that moves to a neighbour
// takes whatever lies there along: faces that coincide go on coinciding. Holes that are filled alike keep that, too,
// and are filled as well as those of a single sheet.

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "simplify/removal_evaluator.h"
#include "simplify/site_walk.h"

namespace lodestone::detail {
namespace {

/// Whether a removal leaves a hole to fill; corners do not.
bool leaves_hole(const Star& star) { return star.is_plain() || star.sector_count() == (star.closed ? 2 : 1); }

/// Adds what the removal of another copy costs. Copies that lie on one another move one surface, however often it is
/// there.
void take_worse(Evaluation& worst, const Evaluation& found) {
  if (rejects(found.verdict)) worst.verdict = found.verdict;
  worst.cost = std::max(worst.cost, found.cost);
  worst.curvature_error = std::max(worst.curvature_error, found.curvature_error);
}

}  // namespace

/// Fills the holes of all copies alike where their sheets coincide; elsewhere tries the places that the first copy may
/// move to, for all copies at once. Either way faces that lie on one another go on doing so.
Evaluation RemovalEvaluator::evaluate_copies(Index vertex, Removal& removal, Choice& choice) {
  if (choice[1] != kAlongSpoke) {
    const Evaluation layers = evaluate_layers(vertex, removal, choice);
    if (!rejects(layers.verdict)) return layers;
  }
  if (const Verdict verdict = gather(vertex); rejects(verdict)) return {verdict};
  std::vector<std::pair<std::size_t, Index>> targets;
  for (std::size_t spoke = 0; spoke < ring_size(); ++spoke)
    if (is_target(spoke)) targets.emplace_back(spoke, state_->connectivity.site(ring_vertex_[spoke]));
  Evaluation best{Verdict::Link};
  const Choice given = choice;
  for (const auto& [spoke, site] : targets) {
    if (given[1] == kAlongSpoke && given[0] != spoke) continue;
    if (!take_better(best, evaluate_copies_at(vertex, site, trial_copies_))) continue;
    choice = {static_cast<std::uint8_t>(spoke), kAlongSpoke};
    std::swap(removal, trial_copies_);
  }
  return best;
}

/// Fills the holes of all copies with the triangles that are best for the one with the most faces.
Evaluation RemovalEvaluator::evaluate_layers(Index vertex, Removal& removal, Choice& choice) {
  const Connectivity& mesh = state_->connectivity;
  const Index widest = widest_copy(vertex);
  removal.resize(1);
  if (const Verdict verdict = gather(widest); rejects(verdict)) return {verdict};
  if (!leaves_hole(star_)) return {Verdict::Link};
  Evaluation worst = evaluate_hole(removal.front(), choice);
  for (Index copy = mesh.next_copy(widest); copy != widest && !rejects(worst.verdict); copy = mesh.next_copy(copy)) {
    if (const Verdict verdict = gather(copy); rejects(verdict)) return {verdict};
    if (!leaves_hole(star_)) return {Verdict::Link};
    removal.emplace_back();
    take_worse(worst, evaluate_layer(removal.front(), removal.back()));
  }
  return worst;
}

/// Fills a copy's hole like that of another.
Evaluation RemovalEvaluator::evaluate_layer(const RemovalRecord& filled, RemovalRecord& record) {
  describe_removal(state_->connectivity, star_, record);
  take_sectors(record, 0);
  if (const Verdict verdict = check_closing_edge(); rejects(verdict)) return {verdict};
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    SectorPatch& patch = record.sectors[s];
    if (!copy_triangles(filled, patch)) return {Verdict::Link};
    if (const Verdict verdict = judge_filled(sectors_[s], patch); rejects(verdict)) return {verdict};
  }
  return combine(record);
}

/// Gives a sector the triangles that lie on its polygon in another copy; false where its faces do not all lie on faces
/// of that copy, or not all of its hole is filled.
bool RemovalEvaluator::copy_triangles(const RemovalRecord& filled, SectorPatch& patch) {
  const Connectivity& mesh = state_->connectivity;
  const auto site = [&](Index wedge) { return mesh.site(mesh.vertex_of_wedge(wedge)); };
  patch.triangles.clear();
  const std::size_t size = patch.polygon.size();
  for (Index i = 0; i < size; ++i) ring_of_site_[site(patch.polygon[i])] = i;
  const bool wraps = patch.shape == SectorShape::Closed;
  const auto follows = [&](Index a, Index b) { return b == a + 1 || (wraps && b == 0 && a + 1 == size); };
  std::size_t coincident = 0;
  for (const SectorPatch& sector : filled.sectors) {
    const auto number = [&](std::size_t i) { return ring_of_site_[site(sector.polygon[i % sector.polygon.size()])]; };
    for (std::size_t i = 0; i < sector.face_count(); ++i) {
      const Index a = number(i), b = number(i + 1);
      if (a != kNoIndex && b != kNoIndex && (follows(a, b) || follows(b, a))) ++coincident;
    }
    for (const PolygonTriangle t : sector.triangles) {
      std::array<Index, 3> corner{number(t.a), number(t.b), number(t.c)};
      std::sort(corner.begin(), corner.end());
      if (corner[2] == kNoIndex) continue;
      const auto narrow = [&](std::size_t k) { return static_cast<std::uint8_t>(corner[k]); };
      patch.triangles.push_back({narrow(0), narrow(1), narrow(2)});
    }
  }
  for (const Index wedge : patch.polygon) ring_of_site_[site(wedge)] = kNoIndex;
  return coincident == patch.face_count() && patch.triangles.size() + 2 == size;
}

/// The copy with the most faces; of those with as many, the one at most lines.
Index RemovalEvaluator::widest_copy(Index vertex) {
  const Connectivity& mesh = state_->connectivity;
  Index widest = vertex;
  std::pair<std::size_t, std::size_t> most{0, 0};
  for (Index copy = vertex;;) {
    mesh.gather_star(copy, star_);
    const std::pair size(star_.corners.size(), star_.sector_count());
    if (size > most) most = size, widest = copy;
    copy = mesh.next_copy(copy);
    if (copy == vertex) return widest;
  }
}

/// Lists the sites that a face joins with the vertex and the target, in any sheet. As that face goes, the edges from
/// both to the site become one.
void RemovalEvaluator::gather_shared_ends(Index vertex, Index target_site) {
  const Connectivity& mesh = state_->connectivity;
  shared_ends_.clear();
  for (Index copy = vertex;;) {
    mesh.gather_star(copy, star_);
    for (const Index corner : star_.corners) {
      const Index next = mesh.site(mesh.vertex(next_corner(corner)));
      const Index previous = mesh.site(mesh.vertex(previous_corner(corner)));
      if (next == target_site) shared_ends_.push_back(previous);
      if (previous == target_site) shared_ends_.push_back(next);
    }
    copy = mesh.next_copy(copy);
    if (copy == vertex) break;
  }
  std::sort(shared_ends_.begin(), shared_ends_.end());
}

Evaluation RemovalEvaluator::evaluate_copies_at(Index vertex, Index target_site, Removal& removal) {
  const Connectivity& mesh = state_->connectivity;
  removal.clear();
  gather_shared_ends(vertex, target_site);
  Evaluation worst{Verdict::Legal};
  for (Index copy = vertex;;) {
    if (const Verdict verdict = gather(copy); rejects(verdict)) return {verdict};
    std::size_t spoke = 0;
    while (spoke < ring_size() && mesh.site(ring_vertex_[spoke]) != target_site) ++spoke;
    if (spoke == ring_size() || !is_target(spoke)) return {Verdict::Link};  // a sheet that does not reach there
    if (falls_onto_face(spoke)) return {Verdict::Link};
    pass_shared_ends(spoke);
    take_worse(worst, evaluate_collapse(spoke, removal.emplace_back()));
    if (rejects(worst.verdict)) return worst;
    copy = mesh.next_copy(copy);
    if (copy == vertex) return worst;
  }
}

/// Whether one of the star's faces would come to lie on another face, and face the same way, as the vertex moves along
/// a spoke. That the two sides of a leaf come to lie on one another is as well.
bool RemovalEvaluator::falls_onto_face(std::size_t target) const {
  for (std::size_t i = 0; i < fine_corner_.size(); ++i) {
    const std::size_t j = (i + 1) % ring_size();
    if (i == target || j == target || !linked(i, target) || !linked(j, target)) continue;
    const Connectivity& mesh = state_->connectivity;
    if (has_face(mesh, ring_vertex_[target], mesh.site(ring_vertex_[i]), mesh.site(ring_vertex_[j]))) return true;
  }
  return false;
}

/// Lets pass the edges of other sheets that become one with a spoke of theirs.
void RemovalEvaluator::pass_shared_ends(std::size_t target) {
  for (std::size_t i = 0; i < ring_size(); ++i) {
    const Index site = state_->connectivity.site(ring_vertex_[i]);
    if (!std::binary_search(shared_ends_.begin(), shared_ends_.end(), site)) continue;
    for (std::uint8_t* link : {&linked_[i * ring_size() + target], &linked_[target * ring_size() + i]})
      *link = *link & kLinkedHere;
  }
}

}  // namespace lodestone::detail

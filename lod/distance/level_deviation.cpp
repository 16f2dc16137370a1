// Branch and bound over both surfaces (see supremum.cpp), with bounds that outlive a level. Backward, from the level to
// the original, a face's bound stays true for as long as the face is there, since the original does not change; a new
// face has that of the faces in whose place it is, and what its removal moved. Forward, it is the faces that a bound
// rests on which move.

#include "distance/level_deviation.h"

#include <algorithm>
#include <numeric>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/grouping.h>

#include "distance/patch_distance.h"
#include "distance/round_up.h"

namespace lodestone::detail {
namespace {

// The lower a bound is, the longer it is of use.
constexpr double kCloseFrom = 0.5;

constexpr Index kNever = kNoIndex - 1;  // of a bound of which it is not known what it rests on

float bound_kept(double bound) { return round_up(bound * kRoundingSlack); }

/// By the names of faces, of which there are so many: the level's face; kNoIndex: none.
std::vector<Index> numbers_of(std::span<const Index> slots, std::size_t slot_count) {
  std::vector<Index> numbers(slot_count, kNoIndex);
  for (Index f = 0; f < slots.size(); ++f) numbers[slots[f]] = f;
  return numbers;
}

}  // namespace

LevelDeviation::Level::Level(const Mesh& original, const Connectivity& current) {
  mesh.corner_wedge.reserve(3 * current.face_count());
  slots.reserve(current.face_count());
  Compaction vertices(original.vertex_count());
  for (Index f = 0; f < current.face_slot_count(); ++f) {
    if (!current.has_face(f)) continue;
    slots.push_back(f);
    for (Index c = 3 * f; c < 3 * f + 3; ++c) mesh.corner_wedge.push_back(vertices.add(current.vertex(c)));
  }
  const std::vector<Index> numbers = numbers_of(slots, current.face_slot_count());
  opposite.reserve(mesh.corner_wedge.size());
  for (const Index f : slots)
    for (Index c = 3 * f; c < 3 * f + 3; ++c) {
      const Index across = current.opposite(previous_corner(c));  // facing the edge that begins at c
      const bool is_border = across == kNoIndex;
      opposite.push_back(is_border ? kNoIndex : 3 * numbers[face_of_corner(across)] + next_corner(across) % 3);
    }
  source = vertices.used();
  mesh.positions = pick_entries(original.positions, source);
  mesh.wedge_vertex.resize(source.size());
  std::iota(mesh.wedge_vertex.begin(), mesh.wedge_vertex.end(), Index{0});
}

LevelDeviation::LevelDeviation(const Mesh& original, const DeviationOptions& options)
    : original_(original),
      options_(options),
      diagonal_(bounding_box(original).diagonal()),
      opposite_(opposite_corners(original)),
      surface_(original, opposite_),
      patch_(original, opposite_, kCloseFrom),
      face_at_(original.vertex_count(), kNoIndex),
      history_(original.face_count()),
      moved_(original.face_count()),
      moved_in_all_(original.face_count()),
      forward_(original, true),
      proved_(original.face_count(), 0),
      since_(original.face_count(), 0),
      backward_(original.face_count()) {
  for (auto f = static_cast<Index>(original.face_count()); f-- > 0;) {
    forward_.witnesses[f].faces.fill(f);
    for (Index corner = 3 * f; corner < 3 * f + 3; ++corner) face_at_[original.corner_vertex(corner)] = f;
  }
  for (Index v = 0; v < face_at_.size(); ++v)
    if (face_at_[v] != kNoIndex) forward_.vertices[v] = {0, face_at_[v], true};
  if (original.face_count() > 0) farthest_point_ = original.corner_position(0);
}

void LevelDeviation::add(const FaceChange& change) {
  history_.now().add(change);
  moved_.add(change);
  moved_in_all_.add(change);
  if (!change.is_vanished) backward_.add(change);
}

/// Brings what is known of the original up to the level. What rests on faces that are forgotten is not known any more.
void LevelDeviation::carry(std::span<const Index> numbers) {
  const Index now = history_.period();
  std::fill(forward_.faces.begin(), forward_.faces.end(), kUnbounded);
  std::fill(forward_.lowered.begin(), forward_.lowered.end(), false);
  const Grouping since(now + 2, since_.size(), [&](Index f) { return std::min(since_[f], now + 1); });
  history_.look_back([&](Index period, std::span<const FaceHistory::Fate> fates) {
    if (period == now) {
      carry_vertices(numbers, fates);
      if (farthest_face_ != kNoIndex && !fates[farthest_face_].is_there()) farthest_face_ = kNoIndex;
    }
    carry_faces(since[period], fates);
  });
  for (const Index f : since[now + 1]) {
    proved_[f] = round_up(static_cast<double>(proved_[f]) + static_cast<double>(moved_.largest));
    forward_.faces[f] = static_cast<double>(proved_[f]);
  }
}

/// A distance grows by what moved the face that it is to; where that has gone before, by the most that anything moved.
void LevelDeviation::carry_vertices(std::span<const Index> numbers, std::span<const FaceHistory::Fate> fates) {
  for (KnownDistance& known : forward_.vertices) {
    known.searched = false;
    const bool is_to_face = known.face != kNoIndex && !known.is_hint;
    if (!is_to_face) known.distance += static_cast<double>(moved_.largest);
    if (known.face == kNoIndex) continue;
    const FaceHistory::Fate& fate = fates[known.face];
    if (!fate.is_there()) {
      if (is_to_face) known.distance += static_cast<double>(fate.moved);
      known.is_hint = true;
      known.face = fate.heir;
    }
    if (known.face != kNoIndex) known.face = numbers[known.face];
  }
}

void LevelDeviation::carry_faces(std::span<const Index> faces, std::span<const FaceHistory::Fate> fates) {
  for (const Index f : faces) {
    bool all_there = true;
    float moved = 0;
    for (const Index witness : forward_.witnesses[f].faces) {
      all_there = all_there && fates[witness].is_there();
      moved = std::max(moved, fates[witness].moved);
    }
    if (all_there) since_[f] = history_.period() + 1;
    forward_.faces[f] = static_cast<double>(proved_[f]) + static_cast<double>(moved);
  }
}

/// Where the level kept a vertex, the surfaces meet. Returns what is known of the level.
SurfaceBounds LevelDeviation::place_vertices(const Level& level) {
  SurfaceBounds backward(level.mesh, false);
  for (Index f = 0; f < level.slots.size(); ++f) backward.faces[f] = static_cast<double>(backward_.of[level.slots[f]]);
  for (Index corner = 0; corner < level.mesh.corner_wedge.size(); ++corner) {
    const Index v = level.mesh.corner_vertex(corner), source = level.source[v];
    forward_.vertices[source] = {0, face_of_corner(corner), true};
    backward.vertices[v] = {0, face_at_[source], true};
  }
  return backward;
}

/// Keeps what was found, with the level's faces by their names.
void LevelDeviation::keep(const Level& level, const SurfaceBounds& backward) {
  for (Index f = 0; f < since_.size(); ++f) {
    if (!forward_.lowered[f]) continue;
    Witnesses& witnesses = forward_.witnesses[f];
    proved_[f] = bound_kept(forward_.faces[f]);
    since_[f] = witnesses.known() ? history_.period() + 1 : kNever;
    if (!witnesses.known()) continue;
    for (Index& witness : witnesses.faces) witness = level.slots[witness];
  }
  for (KnownDistance& known : forward_.vertices)
    if (known.face != kNoIndex) known.face = level.slots[known.face];
  for (Index f = 0; f < level.slots.size(); ++f) backward_.of[level.slots[f]] = bound_kept(backward.faces[f]);
}

double LevelDeviation::bound() const {
  return std::min(measured_ + static_cast<double>(moved_.largest), static_cast<double>(moved_in_all_.largest));
}

Deviation LevelDeviation::measure(const Level& level) {
  const std::vector<Index> numbers = numbers_of(level.slots, original_.face_count());
  carry(numbers);
  SurfaceBounds backward = place_vertices(level);
  TargetSurface level_surface(level.mesh, level.opposite);
  PatchBound level_patch(level.mesh, level.opposite, kCloseFrom);
  SupremumSearch forward_search(original_, level_surface, level_patch, forward_);
  SupremumSearch backward_search(level.mesh, surface_, patch_, backward);
  Goal goal = goal_of(options_, std::max(diagonal_, bounding_box(level.mesh).diagonal()), 0);
  // What was farthest raises the goal at once.
  forward_search.probe(farthest_point_, goal);
  if (farthest_face_ != kNoIndex) backward_search.assume(numbers[farthest_face_], farthest_distance_, goal);
  const Deviation result = narrow_both(forward_search, backward_search, goal, options_.budget);
  if (forward_search.largest_distance() > 0) farthest_point_ = forward_search.farthest_point();
  farthest_face_ = backward_search.farthest_face();
  if (farthest_face_ != kNoIndex) farthest_face_ = level.slots[farthest_face_];
  farthest_distance_ = backward_search.largest_distance();
  keep(level, backward);
  history_.end_period();
  measured_ = result.maximum_bound();
  moved_.reset();
  return result;
}

}  // namespace lodestone::detail

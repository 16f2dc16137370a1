// Vertices that a round brings lie in patches of the coarse mesh. A walk over its faces, from neighbour to neighbour,
// asks of each whether a patch begins there; the patch then grows across its edges, each of which is asked for once.
// That tells place, size and triangulation of the hole at once, in no order but the walk's.
//
// The walk is kin to those of Alliez and Desbrun, Progressive compression for lossless transmission of triangle meshes
// (2001), which fix the triangulation by rule in place of coding it.

#include "codec/patch_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

namespace lodestone::detail {
namespace {

enum Border : std::uint32_t { kCloses, kHasEars, kIsEar, kBorders };

}  // namespace

PatchCoder::PatchCoder(bool is_fast) : model_(PatchModel::make(is_fast)), borders_({kBorders}, 1) {}

bool PatchCoder::code_border(BitCoder& coder, std::uint32_t what, bool yes) {
  return borders_.code(coder, yes ? 1 : 0, std::array<std::uint32_t, 1>{what}, 0) != 0;
}

void PatchCoder::decide(Index face, PatchWalk::State state) {
  walk_.states[face] |= state;
  model_->decide(walk_, face);
}

/// Decides that no patch goes on across a half-edge.
void PatchCoder::close(Index half) {
  const Index face = face_of_corner(half);
  walk_.states[face] = static_cast<std::uint8_t>(walk_.states[face] | PatchWalk::kIsDecided << (half - 3 * face));
}

bool PatchCoder::is_closed(Index half) const {
  const Index face = face_of_corner(half);
  return (walk_.states[face] & PatchWalk::kIsDecided << (half - 3 * face)) != 0;
}

bool PatchCoder::has_corner(Index vertex) const {
  for (const Index corner : walk_.corners)
    if (corner == vertex) return true;
  return false;
}

/// Lets the patch that begins with a face grow, edge by edge.
void PatchCoder::grow(BitCoder& coder, Index seed, const PatchPlan* plan, RoundPatches& patches) {
  const Index patch = plan != nullptr ? plan->patch_of[seed] : 0;
  std::vector<Index>& polygon = walk_.polygon;
  polygon.assign({3 * seed, 3 * seed + 1, 3 * seed + 2});
  walk_.corners.assign({mesh().from(3 * seed), mesh().from(3 * seed + 1), mesh().from(3 * seed + 2)});
  walk_.faces.assign(1, seed);
  decide(seed, PatchWalk::kPatch);
  walk_.lengths = 0;
  for (const Index h : polygon) walk_.lengths += mesh().edge_log(h);
  walk_.crossed = 0;
  model_->change_polygon(walk_);
  std::size_t closing = kNoIndex;
  for (std::size_t i = 0; i < polygon.size();) {
    const Index half = polygon[i], twin = mesh().twin(half);
    if (twin == kNoIndex) {
      if (closing == kNoIndex && code_border(coder, kCloses, plan != nullptr && plan->closing_edge[patch] == half)) {
        closing = i;
        close(half);
      }
      ++i;
      continue;
    }
    const Index beyond = face_of_corner(twin);
    // Corners of a ring are different vertices, and edges are asked for once.
    const bool may_go_on = walk_.state(beyond) == PatchWalk::kOpen && !is_closed(half) &&
                           polygon.size() < kMostPatchCorners && !has_corner(mesh().apex(twin));
    if (!may_go_on || !model_->code_edge(coder, walk_, i, plan != nullptr && plan->patch_of[beyond] == patch)) {
      close(twin);
      ++i;
      continue;
    }
    go_on(i);
  }
  end_patch(closing, patches);
}

/// Adds the face beyond the i-th edge to the patch.
void PatchCoder::go_on(std::size_t i) {
  const Index half = walk_.polygon[i], twin = mesh().twin(half), beyond = face_of_corner(twin);
  decide(beyond, PatchWalk::kPatch);
  walk_.crossed += walk_.is_seam(half) ? 1 : 0;
  walk_.faces.push_back(beyond);
  walk_.lengths += mesh().edge_log(next_corner(twin)) + mesh().edge_log(previous_corner(twin)) - mesh().edge_log(half);
  walk_.polygon[i] = next_corner(twin);
  const auto after = static_cast<std::ptrdiff_t>(i) + 1;
  walk_.polygon.insert(walk_.polygon.begin() + after, previous_corner(twin));
  walk_.corners.insert(walk_.corners.begin() + after, mesh().apex(twin));
  model_->change_polygon(walk_);
}

void PatchCoder::end_patch(std::size_t closing, RoundPatches& patches) {
  std::vector<Index>& polygon = walk_.polygon;
  for (const Index half : polygon) ask_beyond(half);
  model_->end_polygon(walk_);
  const bool closed = closing == kNoIndex;
  if (!closed) {
    std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(closing) + 1, polygon.end());
    polygon.pop_back();
  }
  patches.polygons.insert(patches.polygons.end(), polygon.begin(), polygon.end());
  patches.faces.insert(patches.faces.end(), walk_.faces.begin(), walk_.faces.end());
  patches.patches.push_back(
      {static_cast<Index>(patches.polygons.size()), static_cast<Index>(patches.faces.size()), closed});
}

/// Has the walk ask of the face beyond a half-edge, if it does not yet.
void PatchCoder::ask_beyond(Index half) {
  const Index twin = mesh().twin(half);
  if (twin == kNoIndex) return;
  const Index face = face_of_corner(twin);
  if ((walk_.states[face] & (PatchWalk::kStateBits | PatchWalk::kIsSeen)) != 0) return;
  walk_.states[face] |= PatchWalk::kIsSeen;
  queue_.push_back(face);
}

void PatchCoder::walk(BitCoder& coder, const PatchPlan* plan, Index count, RoundPatches& patches) {
  const auto face_count = static_cast<Index>(mesh().face_count());
  for (Index first = 0; first < face_count && patches.patches.size() < count; ++first) {
    if (walk_.state(first) != PatchWalk::kOpen) continue;
    queue_.assign(1, first);
    for (std::size_t at = 0; at < queue_.size() && patches.patches.size() < count; ++at) {
      const Index face = queue_[at];
      if (walk_.state(face) != PatchWalk::kOpen) continue;
      if (!coder.goes_on()) return;
      if (model_->code_face(coder, walk_, face, plan != nullptr && plan->patch_of[face] != kNoIndex)) {
        grow(coder, face, plan, patches);
        continue;
      }
      decide(face, PatchWalk::kPlain);
      for (Index h = 3 * face; h < 3 * face + 3; ++h) ask_beyond(h);
    }
  }
}

void PatchCoder::code_ears(BitCoder& coder, const PatchPlan* plan, RoundPatches& patches) {
  const bool any = code_border(coder, kHasEars, plan != nullptr && plan->ear_count > 0);
  const auto half_count = static_cast<Index>(3 * mesh().face_count());
  const Index count = any ? coder.code_raw(plan != nullptr ? plan->ear_count : 0, std::bit_width(half_count)) : 0;
  for (Index h = 0; h < half_count && patches.ears.size() < count; ++h)
    if (mesh().twin(h) == kNoIndex && !is_closed(h) &&
        code_border(coder, kIsEar, plan != nullptr && plan->is_ear[h] != 0))
      patches.ears.push_back(h);
}

bool PatchCoder::code(BitCoder& coder, const PatchMesh& mesh, bool has_seams, const GridPoints& positions,
                      std::uint32_t round, const ChangedFaces& changed, const PatchPlan* plan, RoundPatches& patches) {
  walk_.mesh = &mesh;
  walk_.positions = &positions;
  walk_.round = round;
  walk_.has_seams = has_seams;
  walk_.states.assign(mesh.face_count(), PatchWalk::kOpen);
  walk_.changed = changed;
  model_->start(walk_);
  patches.patches.clear();
  patches.polygons.clear();
  patches.faces.clear();
  patches.ears.clear();
  const auto face_count = static_cast<std::int64_t>(mesh.face_count());
  NumberCoder::Guess guess;
  guess.value = 16 * face_count / 6;
  guess.scale = 16 * face_count / 12;
  const auto planned = static_cast<std::int64_t>(plan != nullptr ? plan->closing_edge.size() : 0);
  const std::int64_t count = counts_.code(coder, planned, guess);
  if (count < 0 || count > face_count) return false;
  walk(coder, plan, static_cast<Index>(count), patches);
  code_ears(coder, plan, patches);
  return static_cast<std::int64_t>(patches.patches.size()) == count;
}

}  // namespace lodestone::detail

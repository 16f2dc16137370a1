#include "codec/level_coder.h"

#include <algorithm>
#include <bit>

namespace lodestone::detail {
namespace {

enum BaseBit : std::uint32_t { kIsNew, kIsCopy };

/// Rotates each face so that its largest point stands first.
void rotate_faces(std::vector<Index>& corners) {
  for (auto face = corners.begin(); face != corners.end(); face += 3)
    std::rotate(face, std::max_element(face, face + 3), face + 3);
}

}  // namespace

/// A corner is the next point that none had before, or one of those.
bool LevelCoder::code_corners(BitCoder& coder, BaseMesh& base) {
  const auto point_count = static_cast<Index>(base.positions.size());
  Index used = 0;
  for (Index& corner : base.corners) {
    const std::array<std::uint32_t, 1> context = {kIsNew};
    const bool is_new = base_bits_.code(coder, corner == used ? 1 : 0, context, 0) != 0;
    if (!is_new) corner = coder.code_raw(corner, std::bit_width(std::max<Index>(used, 1) - 1));
    if (is_new) corner = used++;
    if (corner >= std::min(used, point_count)) return false;
  }
  return true;
}

bool LevelCoder::code_sheets(BitCoder& coder, BaseMesh& base) {
  bool any = false;
  for (Index i = 0; i < base.same_as.size(); ++i) any = any || base.same_as[i] != i;
  any = coder.code_raw(any ? 1 : 0, 1) != 0;
  for (Index i = 0; i < base.same_as.size(); ++i) {
    const std::array<std::uint32_t, 1> context = {kIsCopy};
    const bool is_copy = any && base_bits_.code(coder, base.same_as[i] != i ? 1 : 0, context, 0) != 0;
    base.same_as[i] = is_copy ? coder.code_raw(base.same_as[i], std::bit_width(i)) : i;
    if (base.same_as[i] > i || base.same_as[base.same_as[i]] != base.same_as[i]) return false;
  }
  return true;
}

bool LevelCoder::code_base(BitCoder& coder, BaseMesh& base) {
  if (!code_corners(coder, base) || !code_sheets(coder, base)) return false;
  for (Index i = 0; i < base.positions.size(); ++i) {
    const bool is_copy = base.same_as[i] != i;
    if (is_copy) base.positions[i] = base.positions[base.same_as[i]];
    if (!points_.code_base(coder, base.positions[i], is_copy)) return false;
  }
  positions_ = base.positions;
  rotate_faces(base.corners);
  return mesh_.start(base.corners, positions_.size());
}

bool LevelCoder::code_places(BitCoder& coder, const PatchPlan* plan) {
  if (!patch_coder_.code(coder, mesh_, positions_, ++round_number_, plan, patches_)) return false;
  points_.start_round(mesh_, positions_);
  add_vertices();
  return true;
}

void LevelCoder::note_vertex(bool closed) {
  round_.stars.insert(round_.stars.end(), star_.begin(), star_.end());
  round_.vertices.push_back(
      {static_cast<Index>(round_.stars.size()), static_cast<Index>(round_.replaced.size()), closed});
}

/// Ears come first: patches may move the faces that they hang on.
void LevelCoder::add_vertices() {
  round_.vertices.clear();
  round_.stars.clear();
  round_.replaced.clear();
  round_.replaced_corners.clear();
  for (const Index half : patches_.ears) {
    mesh_.add_ear(half, round_number_, star_);
    note_vertex(false);
  }
  std::span<const Index> polygons = patches_.polygons, faces = patches_.faces;
  Index polygon_begin = 0, face_begin = 0;
  for (const RoundPatches::Patch& patch : patches_.patches) {
    const auto polygon = polygons.subspan(polygon_begin, patch.polygon_end - polygon_begin);
    const auto replaced = faces.subspan(face_begin, patch.face_end - face_begin);
    for (const Index face : replaced) {
      const Index* c = mesh_.corners().data() + 3 * std::size_t{face};
      round_.replaced.push_back(face);
      round_.replaced_corners.push_back({c[0], c[1], c[2]});
    }
    mesh_.refine(polygon, replaced, patch.closed, round_number_, star_);
    note_vertex(patch.closed);
    polygon_begin = patch.polygon_end;
    face_begin = patch.face_end;
  }
}

bool LevelCoder::code_points(BitCoder& coder, std::span<const Vec3i> given) {
  const std::size_t first = positions_.size(), count = round_.vertices.size();
  positions_.resize(first + count);
  for (std::size_t i = 0; i < count; ++i)
    positions_[first + i] = PointCoder::guess(mesh_, round_.star(i), round_.vertices[i].closed, positions_);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3i position = given.empty() ? Vec3i{} : given[i];
    if (!points_.code(coder, mesh_, round_.star(i), round_.vertices[i].closed, positions_, position)) return false;
    positions_[first + i] = position;
  }
  return true;
}

}  // namespace lodestone::detail

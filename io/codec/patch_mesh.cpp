#include "codec/patch_mesh.h"

#include <algorithm>

namespace lodestone::detail {

bool PatchMesh::start(std::vector<Index> corners, std::size_t vertex_count) {
  corners_ = std::move(corners);
  twins_.assign(corners_.size(), kNoIndex);
  degree_.assign(vertex_count, 0);
  made_in_.assign(face_count(), 0);
  std::vector<Index> halves(corners_.size());
  for (Index h = 0; h < halves.size(); ++h) {
    halves[h] = h;
    ++degree_[corners_[h]];
    if (from(h) == to(h)) return false;
  }
  const auto low = [&](Index h) { return std::min(from(h), to(h)); };
  const auto high = [&](Index h) { return std::max(from(h), to(h)); };
  std::sort(halves.begin(), halves.end(), [&](Index a, Index b) {
    return low(a) != low(b) ? low(a) < low(b) : high(a) != high(b) ? high(a) < high(b) : a < b;
  });
  for (std::size_t i = 0; i < halves.size();) {
    std::size_t end = i + 1;
    while (end < halves.size() && low(halves[end]) == low(halves[i]) && high(halves[end]) == high(halves[i])) ++end;
    if (end - i > 2) return false;
    if (end - i == 2) {
      if (from(halves[i]) == from(halves[i + 1])) return false;
      twins_[halves[i]] = halves[i + 1];
      twins_[halves[i + 1]] = halves[i];
    }
    i = end;
  }
  return true;
}

Index PatchMesh::refine(std::span<const Index> polygon, std::span<const Index> faces, bool closed, std::uint32_t round,
                        std::vector<Index>& star) {
  outer_.clear();
  for (const Index half : polygon) outer_.push_back({from(half), to(half), twin(half)});
  for (const Index face : faces)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) --degree_[corners_[h]];
  return place_star(closed, faces, round, star);
}

Index PatchMesh::add_ear(Index half, std::uint32_t round, std::vector<Index>& star) {
  outer_.assign(1, {to(half), from(half), half});
  return place_star(false, {}, round, star);
}

Index PatchMesh::place_star(bool closed, std::span<const Index> faces, std::uint32_t round, std::vector<Index>& star) {
  const auto vertex = static_cast<Index>(degree_.size());
  const std::size_t count = outer_.size();
  degree_.push_back(0);
  star.clear();
  for (std::size_t i = 0; i < count; ++i) {
    if (i < faces.size())
      star.push_back(faces[i]);
    else {
      star.push_back(static_cast<Index>(face_count()));
      corners_.resize(corners_.size() + 3);
      twins_.resize(twins_.size() + 3);
      made_in_.push_back(0);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Index first = 3 * star[i];
    const Outer& outer = outer_[i];
    corners_[first] = vertex;
    corners_[first + 1] = outer.from;
    corners_[first + 2] = outer.to;
    twins_[first] = i > 0 ? 3 * star[i - 1] + 2 : closed ? 3 * star[count - 1] + 2 : kNoIndex;
    twins_[first + 1] = outer.twin;
    twins_[first + 2] = i + 1 < count ? 3 * star[i + 1] : closed ? 3 * star[0] : kNoIndex;
    if (outer.twin != kNoIndex) twins_[outer.twin] = first + 1;
    made_in_[star[i]] = round;
    ++degree_[vertex];
    ++degree_[outer.from];
    ++degree_[outer.to];
  }
  return vertex;
}

}  // namespace lodestone::detail

#include "codec/patch_mesh.h"

#include <lodestone/core/detail/edges.h>

namespace lodestone::detail {

bool PatchMesh::start(std::vector<Index> corners, std::size_t vertex_count) {
  corners_ = std::move(corners);
  twins_.assign(corners_.size(), kNoIndex);
  degree_.assign(vertex_count, 0);
  made_in_.assign(face_count(), 0);
  for (const Index vertex : corners_) ++degree_[vertex];
  bool is_surface = true;
  const std::vector<HalfEdge> halves = sorted_edges(corners_);
  for_each_edge(halves, [&](Edge edge) {
    const bool disagree = edge.size() == 2 && edge[0].forward == edge[1].forward;
    if (edge[0].is_loop() || edge.size() > 2 || disagree) is_surface = false;
    if (!is_surface || edge.size() == 1) return;
    twins_[edge[0].corner] = edge[1].corner;
    twins_[edge[1].corner] = edge[0].corner;
  });
  return is_surface;
}

void PatchMesh::refine(std::span<const Index> polygon, std::span<const Index> faces, bool closed, std::uint32_t round,
                       std::vector<Index>& star) {
  outer_.clear();
  for (const Index half : polygon) outer_.push_back({from(half), to(half), twin(half)});
  for (const Index face : faces)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) --degree_[corners_[h]];
  place_star(closed, faces, round, star);
}

void PatchMesh::add_ear(Index half, std::uint32_t round, std::vector<Index>& star) {
  outer_.assign(1, {to(half), from(half), half});
  place_star(false, {}, round, star);
}

void PatchMesh::place_star(bool closed, std::span<const Index> faces, std::uint32_t round, std::vector<Index>& star) {
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
}

}  // namespace lodestone::detail

#include "codec/patch_mesh.h"

#include <algorithm>

#include <lodestone/core/detail/edges.h>

namespace lodestone::detail {
namespace {

constexpr std::size_t kMostHalves = 16;  // of an edge; of more, none are twins

}  // namespace

bool PatchMesh::is_seam(Index half) const {
  const Index other = twin(half);
  return other != kNoIndex && !fit(half, other);
}

/// Whether two half-edges in opposite directions have the same wedges and group.
bool PatchMesh::fit(Index half, Index other) const {
  return wedges_[half] == wedges_[next_corner(other)] && wedges_[next_corner(half)] == wedges_[other] &&
         groups_[face_of_corner(half)] == groups_[face_of_corner(other)];
}

void PatchMesh::start(std::vector<Index> corners, std::vector<Index> wedges, std::vector<Index> groups,
                      std::size_t vertex_count) {
  corners_ = std::move(corners);
  wedges_ = std::move(wedges);
  groups_ = std::move(groups);
  twins_.assign(corners_.size(), kNoIndex);
  degree_.assign(vertex_count, 0);
  made_in_.assign(face_count(), 0);
  for (const Index vertex : corners_) ++degree_[vertex];
  std::vector<Index> halves(corners_.size());
  for (Index h = 0; h < halves.size(); ++h) halves[h] = h;
  join(halves);
}

void PatchMesh::join(std::span<const Index> halves) {
  ++join_count_;
  std::vector<HalfEdge> edges;
  edges.reserve(halves.size());
  for (const Index h : halves) edges.emplace_back(from(h), to(h), h);
  sort_edges(edges);
  const auto pair_up = [&](const HalfEdge& a, const HalfEdge& b) {
    twins_[a.corner] = b.corner;
    twins_[b.corner] = a.corner;
  };
  const auto are_apart = [](const HalfEdge& a, const HalfEdge& b) {
    return face_of_corner(a.corner) != face_of_corner(b.corner);
  };
  for_each_edge(edges, [&](Edge edge) {
    if (edge.size() < 2 || edge.size() > kMostHalves || edge[0].is_loop()) return;
    const HalfEdge* rest[2] = {nullptr, nullptr};  // by direction
    int rest_count[2] = {0, 0};
    for (const HalfEdge& a : edge)
      for (const HalfEdge& b : edge)
        if (a.forward && !b.forward && twin(a.corner) == kNoIndex && twin(b.corner) == kNoIndex && are_apart(a, b) &&
            fit(a.corner, b.corner))
          pair_up(a, b);
    for (const HalfEdge& a : edge) {
      if (twin(a.corner) != kNoIndex) continue;
      rest[a.forward ? 1 : 0] = &a;
      ++rest_count[a.forward ? 1 : 0];
    }
    if (rest_count[0] == 1 && rest_count[1] == 1 && are_apart(*rest[0], *rest[1])) pair_up(*rest[0], *rest[1]);
  });
}

Index PatchMesh::part(Index half) {
  const Index other = twins_[half];
  if (other != kNoIndex) twins_[other] = kNoIndex;
  twins_[half] = kNoIndex;
  return other;
}

void PatchMesh::refine(std::span<const Index> polygon, std::span<const Index> faces, bool closed, Index vertex,
                       std::uint32_t round, std::vector<Index>& star) {
  outer_.clear();
  for (const Index half : polygon)
    outer_.push_back(
        {from(half), to(half), twin(half), wedge(half), wedge(next_corner(half)), group(face_of_corner(half))});
  for (const Index face : faces)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) --degree_[corners_[h]];
  place_star(closed, faces, vertex, round, star);
}

void PatchMesh::add_ear(Index half, Index vertex, std::uint32_t round, std::vector<Index>& star) {
  outer_.assign(1, {to(half), from(half), half, wedge(next_corner(half)), wedge(half), group(face_of_corner(half))});
  place_star(false, {}, vertex, round, star);
}

void PatchMesh::write_face(Index face, const std::array<Index, 3>& vertices, const std::array<Index, 3>& wedges,
                           Index group, std::uint32_t round) {
  if (face == face_count()) {
    append_faces(1);
  } else {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) --degree_[corners_[h]];
  }
  for (Index i = 0; i < 3; ++i) {
    corners_[3 * face + i] = vertices[i];
    wedges_[3 * face + i] = wedges[i];
    twins_[3 * face + i] = kNoIndex;
    ++degree_[vertices[i]];
  }
  groups_[face] = group;
  made_in_[face] = round;
}

void PatchMesh::append_faces(std::size_t count) {
  const std::size_t faces = face_count() + count;
  corners_.resize(3 * faces);
  wedges_.resize(3 * faces);
  twins_.resize(3 * faces);
  groups_.resize(faces);
  made_in_.resize(faces);
}

void PatchMesh::place_star(bool closed, std::span<const Index> faces, Index vertex, std::uint32_t round,
                           std::vector<Index>& star) {
  const std::size_t count = outer_.size();
  if (vertex == degree_.size()) add_vertex();
  star.assign(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(std::min(count, faces.size())));
  for (auto face = static_cast<Index>(face_count()); star.size() < count; ++face) star.push_back(face);
  if (count > faces.size()) append_faces(count - faces.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Index first = 3 * star[i];
    const Outer& outer = outer_[i];
    corners_[first] = vertex;
    corners_[first + 1] = outer.from;
    corners_[first + 2] = outer.to;
    wedges_[first] = kNoIndex;
    wedges_[first + 1] = outer.from_wedge;
    wedges_[first + 2] = outer.to_wedge;
    groups_[star[i]] = outer.group;
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

#include "codec/patch_mesh.h"

#include <algorithm>

#include <lodestone/core/detail/edges.h>

namespace lodestone::detail {
namespace {

constexpr std::size_t kMostHalves = 16;  // of an edge; of more, none are twins

}  // namespace

void PatchMesh::start(std::span<const Index> corners, std::span<const Index> wedges, std::span<const Index> groups,
                      std::size_t vertex_count) {
  face_count_ = groups.size();
  halves_.clear();
  for (const Index vertex : corners) halves_.push_back({vertex, kNoIndex});
  wedges_.assign(wedges.begin(), wedges.end());
  edge_logs_.assign(corners.size(), 0);
  faces_.clear();
  for (const Index group : groups) faces_.push_back({group, 0});
  degree_.assign(vertex_count, 0);
  for (const Index vertex : corners) ++degree_[vertex];
  std::vector<Index> halves(corners.size());
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
    halves_[a.corner].twin = b.corner;
    halves_[b.corner].twin = a.corner;
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
  const Index other = twin(half);
  if (other != kNoIndex) halves_[other].twin = kNoIndex;
  halves_[half].twin = kNoIndex;
  return other;
}

void PatchMesh::refine(std::span<const Index> polygon, std::span<const Index> faces, bool closed, Index vertex,
                       std::uint32_t round, std::vector<Index>& stars) {
  outer_.clear();
  for (const Index half : polygon) {
    const Index next = next_corner(half);
    outer_.push_back(
        {from(half), from(next), twin(half), wedge(half), wedge(next), group(face_of_corner(half)), edge_logs_[half]});
  }
  for (const Index face : faces)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) --degree_[from(h)];
  place_star(closed, faces, vertex, round, stars);
}

void PatchMesh::add_ear(Index half, Index vertex, std::uint32_t round, std::vector<Index>& stars) {
  outer_.assign(1, {to(half), from(half), half, wedge(next_corner(half)), wedge(half), group(face_of_corner(half)),
                    edge_logs_[half]});
  place_star(false, {}, vertex, round, stars);
}

void PatchMesh::write_face(Index face, const std::array<Index, 3>& vertices, const std::array<Index, 3>& wedges,
                           Index group, std::uint32_t round) {
  if (face == face_count_) {
    reserve(1);
    ++face_count_;
  } else {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) --degree_[from(h)];
  }
  for (Index i = 0; i < 3; ++i) {
    halves_[3 * face + i] = {vertices[i], kNoIndex};
    wedges_[3 * face + i] = wedges[i];
    ++degree_[vertices[i]];
  }
  faces_[face] = {group, round};
}

void PatchMesh::reserve(std::size_t more) {
  const std::size_t faces = face_count_ + more;
  if (faces <= faces_.size()) return;
  halves_.resize(3 * faces);
  edge_logs_.resize(3 * faces);
  wedges_.resize(3 * faces);
  faces_.resize(faces);
}

void PatchMesh::place_star(bool closed, std::span<const Index> faces, Index vertex, std::uint32_t round,
                           std::vector<Index>& stars) {
  const std::size_t count = outer_.size(), begin = stars.size();
  if (vertex == degree_.size()) add_vertex();
  const std::size_t kept = std::min(count, faces.size());
  reserve(count - kept);
  for (std::size_t i = 0; i < count; ++i) stars.push_back(i < kept ? faces[i] : static_cast<Index>(face_count_++));
  const Index* const star = stars.data() + begin;
  Index before = closed ? 3 * star[count - 1] + 2 : kNoIndex;  // the half-edge that ends in the vertex
  for (std::size_t i = 0; i < count; ++i) {
    const Index first = 3 * star[i];
    const Outer& outer = outer_[i];
    halves_[first] = {vertex, before};
    halves_[first + 1] = {outer.from, outer.twin};
    halves_[first + 2] = {outer.to, i + 1 < count ? 3 * star[i + 1] : closed ? 3 * star[0] : kNoIndex};
    wedges_[first] = kNoIndex;
    wedges_[first + 1] = outer.from_wedge;
    wedges_[first + 2] = outer.to_wedge;
    edge_logs_[first + 1] = outer.log;
    faces_[star[i]] = {outer.group, round};
    if (outer.twin != kNoIndex) halves_[outer.twin].twin = first + 1;
    ++degree_[outer.from];
    ++degree_[outer.to];
    before = first + 2;
  }
  degree_[vertex] += static_cast<Index>(count);
}

}  // namespace lodestone::detail

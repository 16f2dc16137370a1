// The corner table after Rossignac, Safonova, Szymczak: 3D compression made simple: Edgebreaker on a corner table
// (Shape Modeling International, 2001). Corners name wedges rather than vertices, so that seams need no extra table.

#include <lodestone/core/connectivity.h>

#include <algorithm>
#include <cassert>
#include <numeric>
#include <string>
#include <utility>

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/detail/position_index.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone {

using detail::Edge;
using detail::for_each_edge;
using detail::HalfEdge;
using detail::places_of;
using detail::sorted_edges;
using detail::text;

Result<Connectivity> Connectivity::build(const Mesh& mesh) {
  Connectivity result;
  result.corner_wedge_ = mesh.corner_wedge;
  result.opposite_.assign(mesh.corner_wedge.size(), kNoIndex);
  result.vertex_corner_.assign(mesh.vertex_count(), kNoIndex);
  result.wedge_vertex_ = &mesh.wedge_vertex;
  result.face_material_ = &mesh.face_material;
  result.face_count_ = mesh.face_count();
  LODESTONE_CHECK(result.join_faces(mesh));
  LODESTONE_CHECK(result.anchor_vertices());
  result.link_copies(mesh);
  return result;
}

Result<void> Connectivity::join_faces(const Mesh& mesh) {
  for (Index c = 0; c < corner_wedge_.size(); ++c)
    if (vertex(c) == vertex(next_corner(c)))
      return fail(ErrorCode::InvalidArgument, text("face ", face_of_corner(c), " repeats vertex ", vertex(c)));
  const std::vector<HalfEdge> halves = sorted_edges(mesh);
  for_each_edge(halves, [&](Edge edge) {
    // An edge of several faces, or of two that disagree on winding, stays a border of each.
    if (edge.size() != 2 || edge[0].forward == edge[1].forward) return;
    const Index a = previous_corner(edge[0].corner);
    const Index b = previous_corner(edge[1].corner);
    opposite_[a] = b;
    opposite_[b] = a;
  });
  return {};
}

Index Connectivity::first_corner(Index corner) const {
  for (Index c = corner;;) {
    const Index right = swing_right(c);
    if (right == kNoIndex) return c;
    if (right == corner) return corner;
    c = right;
  }
}

Result<void> Connectivity::anchor_vertices() {
  std::vector<Index> corner_count(vertex_corner_.size(), 0);
  for (Index c = 0; c < corner_wedge_.size(); ++c) {
    const Index v = vertex(c);
    ++corner_count[v];
    if (vertex_corner_[v] == kNoIndex) vertex_corner_[v] = c;
  }
  Star star;
  for (Index v = 0; v < vertex_corner_.size(); ++v) {
    if (vertex_corner_[v] == kNoIndex) continue;
    vertex_corner_[v] = first_corner(vertex_corner_[v]);
    gather_star(v, star);
    if (star.corners.size() != corner_count[v])
      return fail(ErrorCode::InvalidArgument,
                  text("vertex ", v, " has ", corner_count[v], " faces in more than one fan"));
  }
  return {};
}

/// Each vertex is the next of the last copy before it, and goes back to the first.
void Connectivity::link_copies(const Mesh& mesh) {
  const std::vector<Index> site = places_of(mesh.positions);
  std::vector<Index> last(site.size());  // by site: the last of its copies so far
  for (Index v = 0; v < site.size(); ++v) {
    const Index before = std::exchange(last[site[v]], v);
    if (site[v] == v) continue;
    if (next_copy_.empty()) {
      next_copy_.resize(site.size());
      std::iota(next_copy_.begin(), next_copy_.end(), Index{0});
    }
    next_copy_[before] = v;
    next_copy_[v] = site[v];
  }
  if (!next_copy_.empty()) site_ = site;
}

bool Connectivity::is_constrained(Index corner) const {
  const Index across = opposite_[corner];
  if (across == kNoIndex || is_crease(corner)) return true;
  return corner_wedge_[next_corner(corner)] != corner_wedge_[previous_corner(across)] ||
         corner_wedge_[previous_corner(corner)] != corner_wedge_[next_corner(across)] ||
         material(face_of_corner(corner)) != material(face_of_corner(across));
}

void Connectivity::mark_crease(Index corner) {
  if (crease_.empty()) crease_.assign(corner_wedge_.size(), 0);
  crease_[corner] = 1;
  if (opposite_[corner] != kNoIndex) crease_[opposite_[corner]] = 1;
}

void Connectivity::gather_star(Index vertex, Star& star) const {
  star.corners.clear();
  star.sector_begin.clear();
  const Index start = vertex_corner_[vertex];
  assert(start != kNoIndex);
  Index corner = start;
  do {
    star.corners.push_back(corner);
    corner = swing_left(corner);
  } while (corner != kNoIndex && corner != start);
  star.closed = corner == start;

  // The spoke before face i faces that face's previous corner.
  const auto constrained_before = [&](Index c) { return is_constrained(previous_corner(c)); };
  if (star.closed) {
    const auto first = std::find_if(star.corners.begin(), star.corners.end(), constrained_before);
    star.starts_constrained = first != star.corners.end();
    if (star.starts_constrained) std::rotate(star.corners.begin(), first, star.corners.end());
  } else {
    star.starts_constrained = true;
  }
  star.sector_begin.push_back(0);
  if (!star.starts_constrained) return;
  for (Index i = 1; i < star.corners.size(); ++i)
    if (constrained_before(star.corners[i])) star.sector_begin.push_back(i);
}

VertexKind Connectivity::kind(Index vertex) const {
  if (!has_vertex(vertex)) return VertexKind::Isolated;
  Star star;
  gather_star(vertex, star);
  return kind(vertex, star);
}

VertexKind Connectivity::kind(Index vertex, const Star& star) const {
  if (is_copy(vertex)) return VertexKind::NonManifold;
  if (star.is_plain()) return VertexKind::Interior;
  if (!star.closed) return star.sector_count() == 1 ? VertexKind::Border : VertexKind::Corner;
  return star.sector_count() == 2 ? VertexKind::Feature : VertexKind::Corner;
}

bool Connectivity::has_edge(Index a, Index b) const {
  const Index start = vertex_corner_[a];
  for (Index corner = start; corner != kNoIndex;) {
    if (vertex(next_corner(corner)) == b || vertex(previous_corner(corner)) == b) return true;
    corner = swing_left(corner);
    if (corner == start) break;
  }
  return false;
}

}  // namespace lodestone

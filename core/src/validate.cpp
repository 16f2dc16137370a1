#include <lodestone/core/validate.h>

#include <algorithm>
#include <string>
#include <vector>

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/detail/index_limit.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone {
namespace {

using detail::Edge;
using detail::for_each_edge;
using detail::HalfEdge;
using detail::sort_edges;
using detail::text;

auto defect(const std::string& message) { return fail(ErrorCode::InvalidArgument, message); }

Result<void> check_face(const Connectivity& mesh, Index face) {
  const Index a = mesh.vertex(3 * face);
  const Index b = mesh.vertex(3 * face + 1);
  const Index c = mesh.vertex(3 * face + 2);
  if (a == b || b == c || a == c) return defect(text("face ", face, " repeats a vertex"));
  return {};
}

Result<void> check_opposite(const Connectivity& mesh, Index corner) {
  const Index across = mesh.opposite(corner);
  if (across == kNoIndex) return {};
  const std::string name = text("corner ", corner);
  if (across >= 3 * mesh.face_slot_count() || !mesh.has_face(face_of_corner(across)))
    return defect(text(name, " faces corner ", across, ", which no face has"));
  if (mesh.opposite(across) != corner) return defect(text(name, " faces ", across, ", but not back"));
  if (mesh.vertex(next_corner(corner)) != mesh.vertex(previous_corner(across)) ||
      mesh.vertex(previous_corner(corner)) != mesh.vertex(next_corner(across)))
    return defect(text(name, " and ", across, " do not share an edge"));
  return {};
}

Result<void> check_edges(const Connectivity& mesh) {
  std::vector<HalfEdge> halves;
  for (Index c = 0; c < 3 * mesh.face_slot_count(); ++c) {
    // An edge that was cut where sheets meet stays a border on every side; only joined edges have to be unique.
    if (!mesh.has_face(face_of_corner(c)) || mesh.opposite(previous_corner(c)) == kNoIndex) continue;
    halves.emplace_back(mesh.vertex(c), mesh.vertex(next_corner(c)), c);
  }
  sort_edges(halves);
  Index twice = kNoIndex;
  for_each_edge(halves, [&](Edge edge) {
    // Three halves are two of one direction at least.
    if (edge.size() > 2 || (edge.size() == 2 && edge[0].forward == edge[1].forward)) twice = edge[0].corner;
  });
  if (twice == kNoIndex) return {};
  return defect(text("edge between vertices ", mesh.vertex(twice), " and ", mesh.vertex(next_corner(twice)),
                     " appears twice in one direction"));
}

Result<void> check_fans(const Connectivity& mesh) {
  std::vector<Index> corner_count(mesh.vertex_count(), 0);
  for (Index c = 0; c < 3 * mesh.face_slot_count(); ++c)
    if (mesh.has_face(face_of_corner(c))) ++corner_count[mesh.vertex(c)];
  Star star;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const std::string name = text("vertex ", v);
    if (!mesh.has_vertex(v)) {
      if (corner_count[v] != 0) return defect(text(name, " is gone but has ", corner_count[v], " faces"));
      continue;
    }
    const Index anchor = mesh.corner_at(v);
    if (!mesh.has_face(face_of_corner(anchor)) || mesh.vertex(anchor) != v)
      return defect(text(name, " is anchored at corner ", anchor, ", which is not its own"));
    mesh.gather_star(v, star);
    if (star.corners.size() != corner_count[v]) return defect(name + " has more than one fan of faces");
    if (!star.closed && mesh.swing_right(anchor) != kNoIndex) return defect(name + " is not anchored at its border");
  }
  return {};
}

}  // namespace

Result<void> validate(const Mesh& mesh) {
  LODESTONE_CHECK(detail::check_index_limit("vertices", mesh.vertex_count()));
  LODESTONE_CHECK(detail::check_index_limit("wedges", mesh.wedge_count()));
  LODESTONE_CHECK(detail::check_index_limit("corners", mesh.corner_wedge.size()));
  if (mesh.corner_wedge.size() % 3 != 0)
    return defect(text("corner count ", mesh.corner_wedge.size(), " is not a multiple of 3"));
  if (!mesh.face_material.empty() && mesh.face_material.size() != mesh.face_count())
    return defect(text("material count ", mesh.face_material.size(), " differs from face count ", mesh.face_count()));
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w)
    if (mesh.wedge_vertex[w] >= mesh.vertex_count())
      return defect(text("wedge ", w, " names vertex ", mesh.wedge_vertex[w], " of ", mesh.vertex_count()));
  for (std::size_t c = 0; c < mesh.corner_wedge.size(); ++c)
    if (mesh.corner_wedge[c] >= mesh.wedge_count())
      return defect(text("corner ", c, " names wedge ", mesh.corner_wedge[c], " of ", mesh.wedge_count()));
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.data.size() != attribute.element_bytes() * mesh.wedge_count())
      return defect(text("attribute ", attribute.name, " has ", attribute.data.size(), " bytes for ",
                         mesh.wedge_count(), " wedges"));
  return {};
}

Result<void> validate(const Connectivity& mesh) {
  for (Index f = 0; f < mesh.face_slot_count(); ++f) {
    if (!mesh.has_face(f)) continue;
    LODESTONE_CHECK(check_face(mesh, f));
    for (Index c = 3 * f; c < 3 * f + 3; ++c) LODESTONE_CHECK(check_opposite(mesh, c));
  }
  LODESTONE_CHECK(check_edges(mesh));
  return check_fans(mesh);
}

}  // namespace lodestone

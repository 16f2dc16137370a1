#include "pipeline/shown_level.h"

#include <set>
#include <vector>

namespace lodestone::detail {
namespace {

/// Returns the first face of each material that the level has none of.
std::vector<Index> lost_faces(const Mesh& whole, const Mesh& level) {
  std::set<Index> materials;
  for (Index face = 0; face < level.face_count(); ++face) materials.insert(level.material_of(face));
  std::vector<Index> faces;
  for (Index face = 0; face < whole.face_count(); ++face)
    if (materials.insert(whole.material_of(face)).second) faces.push_back(face);
  return faces;
}

template <class T>
void append_all(std::vector<T>& out, const std::vector<T>& more) {
  out.insert(out.end(), more.begin(), more.end());
}

/// Appends a mesh of the same attributes, apart from what is there.
void append_mesh(const Mesh& more, Mesh& mesh) {
  const auto vertices = static_cast<Index>(mesh.vertex_count()), wedges = static_cast<Index>(mesh.wedge_count());
  append_all(mesh.positions, more.positions);
  for (const Index vertex : more.wedge_vertex) mesh.wedge_vertex.push_back(vertices + vertex);
  mesh.face_material.resize(mesh.face_count());
  for (Index face = 0; face < more.face_count(); ++face) mesh.face_material.push_back(more.material_of(face));
  for (const Index wedge : more.corner_wedge) mesh.corner_wedge.push_back(wedges + wedge);
  for (std::size_t i = 0; i < more.attributes.size(); ++i) append_all(mesh.attributes[i].data, more.attributes[i].data);
}

}  // namespace

void keep_every_material(const Mesh& whole, Mesh& level) {
  const std::vector<Index> lost = lost_faces(whole, level);
  if (lost.empty()) return;
  if (level.face_count() == 0)
    level = pick_faces(whole, lost);
  else
    append_mesh(pick_faces(whole, lost), level);
}

}  // namespace lodestone::detail

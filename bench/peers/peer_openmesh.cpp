#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "simplifier.h"

namespace lodestone::bench {
namespace {

using TriMesh = OpenMesh::TriMesh_ArrayKernelT<>;

TriMesh to_openmesh(const Mesh& mesh) {
  TriMesh result;
  for (const Vec3f& p : mesh.positions) result.add_vertex({p.x, p.y, p.z});
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3) {
    const auto vertex = [&](Index corner) {
      return TriMesh::VertexHandle(static_cast<int>(mesh.corner_vertex(corner)));
    };
    result.add_face(vertex(c), vertex(c + 1), vertex(c + 2));
  }
  result.request_face_normals();
  result.update_face_normals();
  return result;
}

Surface from_openmesh(TriMesh& mesh) {
  mesh.garbage_collection();
  Surface surface;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.points.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    std::array<Index, 3> face{};
    int i = 0;
    for (const auto v : f.vertices()) face[i++] = static_cast<Index>(v.idx());
    surface.faces.push_back(face);
  }
  return surface;
}

}  // namespace

std::vector<Level> run_openmesh(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  std::vector<Level> levels;
  for (const std::size_t faces : face_counts) {
    TriMesh copy = to_openmesh(mesh);
    const Clock clock;
    OpenMesh::Decimater::DecimaterT<TriMesh> decimater(copy);
    OpenMesh::Decimater::ModQuadricT<TriMesh>::Handle quadrics;
    decimater.add(quadrics);
    decimater.module(quadrics).unset_max_err();
    // As OpenMesh's own tool for progressive meshes has it: without it faces turn over, and fandisk grows spikes.
    OpenMesh::Decimater::ModNormalFlippingT<TriMesh>::Handle no_flips;
    decimater.add(no_flips);
    decimater.initialize();
    decimater.decimate_to_faces(0, faces);
    const Seconds seconds = clock.seconds();
    levels.push_back({from_openmesh(copy), seconds});
  }
  return levels;
}

}  // namespace lodestone::bench

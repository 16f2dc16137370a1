#pragma once

#include <string>

#include "support/gltf_file.h"
#include "support/shapes.h"

namespace lodestone::test {

/// Adds a mesh of positions only; returns its number.
inline std::size_t add_mesh(GltfMaker& maker, const std::string& name, const TriangleSoup& soup) {
  std::vector<float> positions;
  for (const Vec3f& p : soup.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
  const std::size_t vertices = maker.add_floats(positions, "VEC3", 3);
  const std::size_t indices = maker.add_accessor(soup.indices, 5125, "SCALAR", 1);
  const GltfJson primitive = {{"attributes", {{"POSITION", vertices}}}, {"indices", indices}};
  return maker.add("meshes", {{"name", name}, {"primitives", GltfJson::array({primitive})}});
}

/// Adds a node at the root of the scene that shows a mesh; `members` are further ones.
inline std::size_t add_node(GltfMaker& maker, const std::string& name, std::size_t mesh, GltfJson members = {}) {
  members["name"] = name;
  members["mesh"] = mesh;
  const std::size_t node = maker.add("nodes", std::move(members));
  maker.json["scenes"][0]["nodes"].push_back(node);
  return node;
}

}  // namespace lodestone::test

#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "glb_builder.h"

namespace lodestone::detail {

/// The faces of one material.
struct FacesOfMaterial {
  Index material = 0;
  std::vector<Index> corner_wedge;  ///< three per face, in the order of the mesh
};

/// Splits a mesh's faces by material, ascending. Empty for a mesh without faces.
std::vector<FacesOfMaterial> split_by_material(const Mesh& mesh);

/// The document's materials: a plain one for each number that faces use, in ascending order; 0 stands for none.
class MaterialTable {
 public:
  MaterialTable(GlbBuilder& builder, const std::set<Index>& numbers);
  /// Sets the primitive's material. Pre: the number is one of the table's, or 0.
  void assign(Json& primitive, Index number) const;

 private:
  std::map<Index, std::size_t> index_of_;
};

/// Writes a mesh uncompressed: one vertex buffer, one primitive per material. Returns the mesh's index, or nothing for
/// a mesh without faces, which glTF has no form for.
std::optional<std::size_t> add_plain_mesh(GlbBuilder& builder, const Mesh& mesh, const std::string& name,
                                          const MaterialTable& materials);

/// Returns the mesh with faces and wedges in an order that graphics hardware likes: the vertex cache's, then the order
/// of first use. Faces of one material stay together.
Mesh in_hardware_order(const Mesh& mesh);

/// Returns min and max of positions as glTF wants them beside a POSITION accessor. Pre: there is at least one.
std::pair<Json, Json> position_bounds(std::span<const Vec3f> positions);

}  // namespace lodestone::detail

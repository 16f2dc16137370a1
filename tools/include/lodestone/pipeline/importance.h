#pragma once

#include <map>
#include <string>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/scene.h>

namespace lodestone {

/// What is said of one material or node.
struct PartImportance {
  double factor = 1;  ///< multiplies the cost of its vertices; of a node also its meshes' share of the faces
  bool lock = false;  ///< keep it as it is
};

/// What parts of a scene count in a build.
struct Importance {
  /// The vertex attribute that says what each vertex counts; empty: "_LODESTONE_IMPORTANCE", where the mesh has it.
  std::string attribute;
  std::map<std::string, PartImportance> materials;  ///< by name, as the next
  std::map<std::string, PartImportance> nodes;
};

/// Returns an error for a name that nothing in the scene has: it is likely misspelt.
Result<void> check_names(const Importance& importance, const Scene& scene);

/// Returns the importance of a mesh among those of its scene: the largest of its nodes'.
double importance_of(const SceneMesh& mesh, const Importance& importance);

/// Returns the importance of every vertex of a mesh, or nothing where all are 1. It is the product of what is said of
/// its materials and nodes and of the attribute. A colour's first component c counts 16^(2c − 1), and locks at 1; any
/// other attribute's first component counts as it is. Of several wedges or materials at a vertex the largest counts.
/// Errors: InvalidArgument where an attribute's value is negative or no number.
Result<std::vector<float>> vertex_importance(const SceneMesh& mesh, const Importance& importance);

}  // namespace lodestone

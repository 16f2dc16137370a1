#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/scene.h>

namespace lodestone::tool {

/// What a settings file says of one material or node.
struct PartSettings {
  double importance = 1;  ///< multiplies the cost of its vertices; of a node also its meshes' share of the faces
  bool lock = false;      ///< keep it as it is
};

/// The settings of single materials and nodes, by name.
struct BuildSettings {
  std::map<std::string, PartSettings> materials;
  std::map<std::string, PartSettings> nodes;

  /// The importance of a mesh among those of its scene: the largest of its nodes'.
  double importance_of(const SceneMesh& mesh) const;
};

/// Reads a settings file: {"materials": {NAME: {"importance": 4, "lock": true}}, "nodes": {NAME: …}}.
/// Errors: Unreadable, Malformed, naming the member.
Result<BuildSettings> read_settings(const std::filesystem::path& path);

/// Returns an error for a name that nothing in the scene has: it is likely misspelt.
Result<void> check_names(const BuildSettings& settings, const Scene& scene);

/// Returns the importance of every vertex of a mesh, or nothing where all are alike. It is the product of what the
/// settings say of its materials and nodes and of an attribute: "_LODESTONE_IMPORTANCE" where the mesh has it, or the one
/// named `attribute`. A colour's first component c counts 16^(2c − 1), and locks at 1; any other attribute's first
/// component counts as it is. Of several wedges or materials at a vertex the largest counts.
/// Errors: InvalidArgument where an attribute's value is negative or no number.
Result<std::vector<float>> vertex_importance(const SceneMesh& mesh, const BuildSettings& settings,
                                             const std::string& attribute);

}  // namespace lodestone::tool

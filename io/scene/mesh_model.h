#pragma once

#include <string>
#include <vector>

#include <lodestone/io/read_mesh.h>

#include "model/tinygltf.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// A document of one node and its mesh, made of what is no glTF: all but the geometry of its primitives.
struct MeshModel {
  tinygltf::Model model;
  std::vector<EmbeddedImage> images;        ///< those of the model have neither a uri nor bytes
  std::vector<std::string> material_names;  ///< by primitive; "" for none
};

/// Renumbers the faces' materials as primitives and describes them, and takes the images out of the file. A mesh
/// without faces becomes a node without a mesh.
MeshModel model_of_mesh(MeshFile& file, const std::string& name);

}  // namespace lodestone::detail

#include "scene/write_glb.h"

#include <utility>

#include <lodestone/core/detail/try.h>
#include <lodestone/io/scene.h>

namespace lodestone::detail {

Result<std::vector<std::byte>> to_glb(const Mesh& mesh, const std::string& name) {
  MeshFile file;
  file.mesh = mesh;
  LODESTONE_TRY(const Scene scene, Scene::from_mesh(std::move(file), name));
  std::vector<LeveledMesh> levels(scene.meshes().size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].levels.resize(1);
    levels[i].levels[0].mesh = scene.meshes()[i].mesh;
  }
  AssetOptions options;
  options.draco = false;
  LODESTONE_TRY(EncodedAsset asset, encode_scene_level(scene, levels, 0, options));
  return std::move(asset.glb);
}

}  // namespace lodestone::detail

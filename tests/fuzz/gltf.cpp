// The glTF readers: the flattened mesh, the asset with its levels, the scene; and the scene's writer.

#include <algorithm>
#include <cstdlib>

#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>

#include "support/fuzz.h"
#include "support/shapes.h"

std::vector<lodestone::test::Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    LeveledMesh mesh;
    mesh.levels.resize(2);
    mesh.levels[0].mesh = assemble(seam_cube(2))->mesh;
    mesh.levels[1].mesh = assemble(seam_cube(1))->mesh;
    const auto scene = Scene::from_mesh({mesh.levels[0].mesh, {}, {}, {}, {}}, "cube");
    AssetOptions options;
    options.compression = compression;
    const auto asset = encode_scene(*scene, std::span(&mesh, 1), options);
    if (!asset) continue;
    seeds.push_back(bytes_of(asset->glb));
  }
  return seeds;
}

namespace {

/// Writes a scene again in two levels, the coarser of half the faces: it works, or says why not.
void encode_again(const lodestone::Result<lodestone::Scene>& scene) {
  if (!scene) {
    if (scene.error().message.empty()) std::abort();
    return;
  }
  std::vector<lodestone::LeveledMesh> meshes;
  for (const lodestone::SceneMesh& mesh : scene->meshes()) {
    meshes.emplace_back().levels.resize(2);
    meshes.back().levels[0].mesh = meshes.back().levels[1].mesh = mesh.mesh;
    lodestone::Mesh& coarse = meshes.back().levels[1].mesh;
    coarse.corner_wedge.resize(coarse.face_count() / 2 * 3);
    coarse.face_material.resize(std::min(coarse.face_material.size(), coarse.face_count()));
  }
  for (const lodestone::Compression compression :
       {lodestone::Compression::None, lodestone::Compression::Draco, lodestone::Compression::Meshopt}) {
    lodestone::AssetOptions options;
    options.compression = compression;
    const auto asset = encode_scene(*scene, meshes, options);
    if (!asset && asset.error().message.empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto file = lodestone::read_mesh_bytes(bytes, "gltf");
  if (!file && file.error().message.empty()) std::abort();
  encode_again(lodestone::Scene::read_bytes(bytes, "gltf"));
  const auto asset = lodestone::Asset::read_bytes(bytes);
  if (!asset) {
    if (asset.error().message.empty()) std::abort();
    return 0;
  }
  const auto levels = asset->levels();
  const auto streams = asset->streams();
  if ((!levels && levels.error().message.empty()) || (!streams && streams.error().message.empty())) std::abort();
  encode_again(asset->scene());
  return 0;
}

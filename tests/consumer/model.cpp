// Builds a multi-LOD asset of a model that a program made with tinygltf, and looks at it as such a model again.

#ifdef WITH_OWN_TINYGLTF
#define TINYGLTF_IMPLEMENTATION  // its code, in place of that in lodestone::io
#endif
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <cstdio>

#include <lodestone/io/tinygltf_model.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/pipeline/build_asset.h>

#include "square.h"

int main() {
  const auto square = lodestone::assemble(square_soup());
  const auto glb = lodestone::write_mesh_bytes(square->mesh, "square.glb");
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  if (!glb ||
      !loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(glb->data()),
                                   static_cast<unsigned>(glb->size())))
    return std::fprintf(stderr, "%s\n", error.c_str()), 1;
  model.nodes[0].name = "field";

  const auto scene = lodestone::scene_from_model(model);
  if (!scene) return std::fprintf(stderr, "%s\n", scene.error().message.c_str()), 1;
  lodestone::BuildOptions options;
  options.storage.compression = lodestone::Compression::None;  // tinygltf loads no Draco
  const auto built = lodestone::build_asset(*scene, options);
  if (!built) return std::fprintf(stderr, "%s\n", built.error().message.c_str()), 1;
  const auto levels = lodestone::model_from_asset(built->files[0]);
  if (!levels) return std::fprintf(stderr, "%s\n", levels.error().message.c_str()), 1;
  for (const tinygltf::Mesh& mesh : levels->meshes) {
    const int indices = mesh.primitives[0].indices;
    std::printf("%s: %zu faces\n", mesh.name.c_str(), levels->accessors[static_cast<std::size_t>(indices)].count / 3);
  }
  return levels->meshes.size() == built->levels.size() && levels->nodes[0].name == "field" ? 0 : 1;
}

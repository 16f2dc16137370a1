// A scene of what is no glTF: one mesh, its materials as glTF's, their images inside.

#include <utility>

#include <lodestone/core/detail/try.h>
#include <lodestone/io/scene.h>

#include "model/write_model.h"
#include "scene/mesh_model.h"
#include "scene/scene_impl.h"
#include "scene/scene_mesh.h"
#include "scene/scene_places.h"

namespace lodestone {

using namespace detail;

Result<Scene> Scene::from_mesh(MeshFile file, const std::string& name) {
  auto scene = std::make_shared<Impl>();
  MeshModel made = model_of_mesh(file, name);
  LODESTONE_TRY(const std::vector<std::byte> glb, write_model(made.model));
  LODESTONE_TRY(scene->document, GltfDocument::parse(glb, nothing_beside));
  scene->images = std::move(made.images);
  scene->notes = std::move(file.notes);
  if (made.material_names.empty()) {
    scene->dropped.push_back(file.assembly);
    return Scene(std::move(scene));
  }
  MeshSource source = source_of(file.mesh, made.material_names.size());
  source.nodes = {0};
  SceneMesh mesh;
  mesh.name = name;
  mesh.mesh = std::move(file.mesh);
  mesh.assembly = file.assembly;
  mesh.materials = std::move(made.material_names);
  scene->meshes.push_back(std::move(mesh));
  scene->sources.push_back(std::move(source));
  LODESTONE_CHECK(measure_instances(*scene));
  return Scene(std::move(scene));
}

}  // namespace lodestone

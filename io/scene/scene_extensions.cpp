#include "scene/scene_extensions.h"

#include <algorithm>
#include <set>

#include "gltf/gltf_attribute.h"
#include "scene/stream_extension.h"

namespace lodestone::detail {
namespace {

/// What the primitives need that stay as they are.
struct KeptNeeds {
  bool draco = false;
  bool quantization = false;
};

bool needs_quantization(const GltfDocument& document, const std::string& name, const Json& index) {
  const auto number = as_size(index);
  const auto type = number ? document.accessor_type(*number) : fail(ErrorCode::Malformed, "");
  if (!type || type->type == ComponentType::Float32) return false;
  if (name == "POSITION") return true;
  const auto semantic = gltf_semantic({name, type->type, type->component_count, type->normalized, {}});
  return semantic && semantic->needs_quantization;
}

void add_primitive(const GltfDocument& document, const Json& primitive, KeptNeeds& needs) {
  needs.draco |= GltfDocument::extension(primitive, "KHR_draco_mesh_compression") != nullptr;
  const auto add = [&](const Json* attributes) {
    if (attributes == nullptr || !attributes->is_object()) return;
    for (const auto& [name, index] : attributes->items())
      needs.quantization |= needs_quantization(document, name, index);
  };
  add(find_member(primitive, "attributes"));
  const Json* targets = find_member(primitive, "targets");
  if (targets == nullptr || !targets->is_array()) return;
  for (const Json& target : *targets) add(&target);
}

KeptNeeds find_needs(const Scene::Impl& scene) {
  KeptNeeds needs;
  std::vector<const MeshSource*> source_of(scene.document.count("meshes"));
  for (const MeshSource& source : scene.sources) source_of[source.mesh] = &source;
  for (std::size_t mesh = 0; mesh < source_of.size(); ++mesh) {
    const Json* primitives = find_member(scene.document.list("meshes")[mesh], "primitives");
    if (primitives == nullptr || !primitives->is_array()) continue;
    for (std::size_t i = 0; i < primitives->size(); ++i)
      if (source_of[mesh] == nullptr || !source_of[mesh]->primitives[i].replaced)
        add_primitive(scene.document, (*primitives)[i], needs);
  }
  return needs;
}

void drop_names(Json& document, const char* list, const std::set<std::string>& dropped) {
  const Json* names = find_member(document, list);
  if (names == nullptr) return;
  Json kept = Json::array();
  if (names->is_array())
    for (const Json& name : *names)
      if (name.is_string() && !dropped.contains(name.get<std::string>())) kept.push_back(name);
  if (kept.empty())
    document.erase(list);
  else
    document[list] = std::move(kept);
}

}  // namespace

void drop_replaced_extensions(const Scene::Impl& scene, Json& document) {
  std::set<std::string> dropped = {"EXT_meshopt_compression", "KHR_meshopt_compression", kStreamExtension};
  const KeptNeeds needs = find_needs(scene);
  if (!needs.draco) dropped.insert("KHR_draco_mesh_compression");
  if (!needs.quantization) dropped.insert("KHR_mesh_quantization");
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) drop_names(document, list, dropped);
}

}  // namespace lodestone::detail

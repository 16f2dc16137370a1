#include "model/model_depth.h"

#include <algorithm>

namespace lodestone::detail {
namespace {

bool value_nests(const tinygltf::Value& value, std::size_t depth) {
  if (!value.IsArray() && !value.IsObject()) return false;
  if (depth == 0) return true;
  if (value.IsArray()) {
    for (int i = 0; i < static_cast<int>(value.ArrayLen()); ++i)
      if (value_nests(value.Get(i), depth - 1)) return true;
    return false;
  }
  const auto& members = value.Get<tinygltf::Value::Object>();
  return std::any_of(members.begin(), members.end(),
                     [&](const auto& member) { return value_nests(member.second, depth - 1); });
}

/// Looks through the parts of a model, one after the other.
class DepthCheck {
 public:
  explicit DepthCheck(std::size_t depth) : depth_(depth) {}

  bool found() const { return found_; }

  void add(const tinygltf::ExtensionMap& extensions) {
    for (const auto& [name, value] : extensions) found_ = found_ || value_nests(value, depth_);
  }
  template <class Part>
  void add(const Part& part) {
    found_ = found_ || value_nests(part.extras, depth_);
    add(part.extensions);
  }
  template <class Part>
  void add_all(const std::vector<Part>& parts) {
    for (const Part& part : parts) add(part);
  }

 private:
  std::size_t depth_;
  bool found_ = false;
};

void add_animations(const tinygltf::Model& model, DepthCheck& check) {
  check.add_all(model.animations);
  for (const tinygltf::Animation& animation : model.animations) {
    check.add_all(animation.samplers);
    check.add_all(animation.channels);
    for (const tinygltf::AnimationChannel& channel : animation.channels) check.add(channel.target_extensions);
  }
}

void add_materials(const tinygltf::Model& model, DepthCheck& check) {
  check.add_all(model.materials);
  for (const tinygltf::Material& material : model.materials) {
    check.add(material.pbrMetallicRoughness);
    check.add(material.pbrMetallicRoughness.baseColorTexture);
    check.add(material.pbrMetallicRoughness.metallicRoughnessTexture);
    check.add(material.normalTexture);
    check.add(material.occlusionTexture);
    check.add(material.emissiveTexture);
  }
}

void add_views_and_lights(const tinygltf::Model& model, DepthCheck& check) {
  check.add_all(model.cameras);
  for (const tinygltf::Camera& camera : model.cameras) {
    check.add(camera.perspective);
    check.add(camera.orthographic);
  }
  check.add_all(model.lights);
  for (const tinygltf::Light& light : model.lights) check.add(light.spot);
}

/// KHR_audio_emitter, which tinygltf knows since 2.8.
template <class Model>
void add_sounds(const Model& model, DepthCheck& check) {
  if constexpr (requires { model.audioSources; }) {
    check.add_all(model.audioSources);
    check.add_all(model.audioEmitters);
    for (const auto& emitter : model.audioEmitters) check.add(emitter.positional);
  }
}

}  // namespace

bool nests_deeper(const tinygltf::Model& model, std::size_t depth) {
  DepthCheck check(depth);
  check.add(model);
  check.add(model.asset);
  check.add_all(model.accessors);
  check.add_all(model.buffers);
  check.add_all(model.bufferViews);
  check.add_all(model.images);
  check.add_all(model.meshes);
  for (const tinygltf::Mesh& mesh : model.meshes) check.add_all(mesh.primitives);
  check.add_all(model.nodes);
  check.add_all(model.samplers);
  check.add_all(model.scenes);
  check.add_all(model.skins);
  check.add_all(model.textures);
  add_animations(model, check);
  add_materials(model, check);
  add_views_and_lights(model, check);
  add_sounds(model, check);
  return check.found();
}

}  // namespace lodestone::detail

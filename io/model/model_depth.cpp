#include "model/model_depth.h"

#include <algorithm>
#include <tuple>

namespace lodestone::detail {
namespace {

// The parts of which a part consists, that have extras and extensions of their own.

template <class Part>
auto parts_of(const Part& part) {
  if constexpr (requires { part.positional; })  // KHR_audio_emitter, which tinygltf knows since 2.8
    return std::tie(part.positional);
  else if constexpr (requires { part.sparse.extras; })  // since 2.9
    return std::tie(part.sparse, part.sparse.indices, part.sparse.values);
  else
    return std::tuple<>();
}

auto parts_of(const tinygltf::Animation& part) { return std::tie(part.samplers, part.channels); }
auto parts_of(const tinygltf::AnimationChannel& part) { return std::tie(part.target_extensions); }
auto parts_of(const tinygltf::Camera& part) { return std::tie(part.perspective, part.orthographic); }
auto parts_of(const tinygltf::Light& part) { return std::tie(part.spot); }
auto parts_of(const tinygltf::Material& part) {
  return std::tie(part.pbrMetallicRoughness, part.normalTexture, part.occlusionTexture, part.emissiveTexture);
}
auto parts_of(const tinygltf::Mesh& part) { return std::tie(part.primitives); }
auto parts_of(const tinygltf::PbrMetallicRoughness& part) {
  return std::tie(part.baseColorTexture, part.metallicRoughnessTexture);
}

template <class Model>
auto sounds_of(const Model& model) {
  if constexpr (requires { model.audioSources; })
    return std::tie(model.audioSources, model.audioEmitters);
  else
    return std::tuple<>();
}

auto parts_of(const tinygltf::Model& m) {
  return std::tuple_cat(std::tie(m.accessors, m.animations, m.asset, m.buffers, m.bufferViews, m.cameras, m.images,
                                 m.lights, m.materials, m.meshes, m.nodes, m.samplers, m.scenes, m.skins, m.textures),
                        sounds_of(m));
}

bool nests(const tinygltf::Value& value, std::size_t depth) {
  if (!value.IsArray() && !value.IsObject()) return false;
  if (depth == 0) return true;
  if (value.IsArray()) {
    for (int i = 0; i < static_cast<int>(value.ArrayLen()); ++i)
      if (nests(value.Get(i), depth - 1)) return true;
    return false;
  }
  const auto& members = value.Get<tinygltf::Value::Object>();
  return std::any_of(members.begin(), members.end(),
                     [&](const auto& member) { return nests(member.second, depth - 1); });
}

bool nests(const tinygltf::ExtensionMap& extensions, std::size_t depth) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& extension) { return nests(extension.second, depth); });
}

template <class Part>
bool nests(const Part& part, std::size_t depth);

template <class Part>
bool nests(const std::vector<Part>& parts, std::size_t depth) {
  return std::any_of(parts.begin(), parts.end(), [&](const Part& part) { return nests(part, depth); });
}

template <class Part>
bool nests(const Part& part, std::size_t depth) {
  return nests(part.extras, depth) || nests(part.extensions, depth) ||
         std::apply([&](const auto&... parts) { return (nests(parts, depth) || ...); }, parts_of(part));
}

}  // namespace

bool nests_deeper(const tinygltf::Model& model, std::size_t depth) { return nests(model, depth); }

}  // namespace lodestone::detail

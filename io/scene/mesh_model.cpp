#include "scene/mesh_model.h"

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <lodestone/core/detail/text.h>

#include "gltf/glb_builder.h"
#include "model/write_model.h"

namespace lodestone::detail {
namespace {

constexpr const char* kTextureTransform = "KHR_texture_transform";
constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";

/// Renumbers the faces' materials as primitives, and returns the materials' numbers by primitive.
std::vector<Index> number_primitives(Mesh& mesh) {
  std::map<Index, Index> primitive_of;
  for (const Index material : mesh.face_material) primitive_of[material] = 0;
  if (mesh.face_material.empty() && mesh.face_count() > 0) primitive_of[0] = 0;
  std::vector<Index> materials;
  for (auto& [material, primitive] : primitive_of) {
    primitive = static_cast<Index>(materials.size());
    materials.push_back(material);
  }
  for (Index& material : mesh.face_material) material = primitive_of[material];
  if (materials.size() <= 1) mesh.face_material.clear();
  return materials;
}

/// What the colours of vertices ask of materials.
struct VertexColors {
  bool any = false;
  bool translucent = false;
};

/// Colours whose alpha is 0 throughout are an exporter's that has none.
VertexColors look_at_colors(const Mesh& mesh) {
  VertexColors found;
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.name != "COLOR_0") continue;
    found.any = true;
    if (attribute.component_count != 4) continue;
    const std::vector<float> values = attribute_values(attribute);
    bool below_one = false, above_zero = false;
    for (std::size_t i = 3; i < values.size(); i += 4) {
      below_one |= values[i] < 1;
      above_zero |= values[i] > 0;
    }
    found.translucent = below_one && above_zero;
  }
  return found;
}

template <class Thing>
int push(std::vector<Thing>& list, Thing thing) {
  list.push_back(std::move(thing));
  return static_cast<int>(list.size() - 1);
}

template <std::size_t n>
std::vector<double> doubles(const std::array<float, n>& values) {
  return {values.begin(), values.end()};
}

tinygltf::Value pair_value(const std::array<float, 2>& values) {
  return tinygltf::Value(
      tinygltf::Value::Array{tinygltf::Value(double{values[0]}), tinygltf::Value(double{values[1]})});
}

/// Writes a model's materials with the textures, samplers and images that they use.
class MaterialWriter {
 public:
  MaterialWriter(MeshModel& made, MeshFile& file) : made_(made), model_(made.model), file_(file) {}

  /// Returns the material's number in the model.
  int add(const Material& material, bool translucent) {
    tinygltf::Material out;
    out.name = as_utf8(material.name);
    tinygltf::PbrMetallicRoughness& surface = out.pbrMetallicRoughness;
    surface.metallicFactor = material.metallic;
    surface.roughnessFactor = material.roughness;
    surface.baseColorFactor = doubles(material.base_color);
    set_texture(surface.baseColorTexture, material.base_color_texture);
    set_texture(surface.metallicRoughnessTexture, material.metallic_roughness_texture);
    set_texture(out.normalTexture, material.normal_texture);
    out.normalTexture.scale = material.normal_scale;
    set_texture(out.emissiveTexture, material.emissive_texture);
    set_emission(out, material.emissive);
    if (material.translucent || translucent) out.alphaMode = "BLEND";
    return push(model_.materials, std::move(out));
  }

 private:
  void use_extension(const char* name) {
    std::vector<std::string>& used = model_.extensionsUsed;
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
  }

  template <class Info>
  void set_texture(Info& info, const std::optional<Texture>& texture) {
    if (!texture) return;
    info.index = texture_number(*texture);
    tinygltf::Value::Object transform;
    if (texture->offset != std::array<float, 2>{0, 0}) transform["offset"] = pair_value(texture->offset);
    if (texture->scale != std::array<float, 2>{1, 1}) transform["scale"] = pair_value(texture->scale);
    if (transform.empty()) return;
    info.extensions[kTextureTransform] = tinygltf::Value(std::move(transform));
    use_extension(kTextureTransform);
  }

  int texture_number(const Texture& texture) {
    const auto [entry, is_new] = textures_.try_emplace({texture.image, texture.clamp});
    if (!is_new) return entry->second;
    tinygltf::Texture out;
    out.source = image_number(texture.image);
    if (texture.clamp) {
      tinygltf::Sampler sampler;
      sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
      out.sampler = push(model_.samplers, std::move(sampler));
    }
    return entry->second = push(model_.textures, std::move(out));
  }

  int image_number(std::size_t number) {
    const auto [entry, is_new] = image_numbers_.try_emplace(number);
    if (!is_new) return entry->second;
    Image& image = file_.images[number];
    tinygltf::Image out;
    out.name = as_utf8(std::filesystem::path(image.name).filename().string());
    entry->second = push(model_.images, std::move(out));
    made_.images.push_back(
        {static_cast<std::size_t>(entry->second), std::move(image.mime_type), std::move(image.bytes)});
    return entry->second;
  }

  void set_emission(tinygltf::Material& out, std::array<float, 3> emissive) {
    const float strength = *std::max_element(emissive.begin(), emissive.end());
    if (!(strength > 0)) return;
    if (strength > 1) {
      for (float& component : emissive) component /= strength;
      out.extensions[kEmissiveStrength] =
          tinygltf::Value(tinygltf::Value::Object{{"emissiveStrength", tinygltf::Value(double{strength})}});
      use_extension(kEmissiveStrength);
    }
    out.emissiveFactor = doubles(emissive);
  }

  MeshModel& made_;
  tinygltf::Model& model_;
  MeshFile& file_;
  std::map<std::pair<std::size_t, bool>, int> textures_;
  std::map<std::size_t, int> image_numbers_;
};

/// Returns the material of each primitive, by the numbers that faces have for them; nothing where there is none.
std::vector<std::optional<Material>> materials_of(const MeshFile& file, std::span<const Index> numbers,
                                                  const VertexColors& colors) {
  std::vector<std::optional<Material>> materials;
  for (const Index number : numbers) {
    if (number > 0 && number <= file.materials.size()) {
      materials.emplace_back(file.materials[number - 1]);
    } else if (number > 0 || colors.any) {  // without one, glTF's would be metal
      materials.emplace_back(Material{});
      if (number > 0) materials.back()->name = text("material ", number);
    } else {
      materials.emplace_back();
    }
  }
  return materials;
}

/// One scene of one node, which shows the mesh if it has primitives.
tinygltf::Model one_node(const std::string& name, std::size_t primitive_count) {
  tinygltf::Model model;
  model.asset.generator = kGenerator;
  model.defaultScene = 0;
  model.scenes.resize(1);
  model.scenes[0].nodes = {0};
  model.nodes.resize(1);
  model.nodes[0].name = as_utf8(name);
  if (primitive_count == 0) return model;
  model.nodes[0].mesh = 0;
  model.meshes.resize(1);
  model.meshes[0].name = model.nodes[0].name;
  model.meshes[0].primitives.resize(primitive_count);
  for (tinygltf::Primitive& primitive : model.meshes[0].primitives) primitive.mode = TINYGLTF_MODE_TRIANGLES;
  return model;
}

}  // namespace

MeshModel model_of_mesh(MeshFile& file, const std::string& name) {
  const std::vector<Index> numbers = number_primitives(file.mesh);
  const VertexColors colors = look_at_colors(file.mesh);
  MeshModel made{one_node(name, numbers.size()), {}, {}};
  MaterialWriter writer(made, file);
  for (const auto& material : materials_of(file, numbers, colors)) {
    if (material) {
      const int number = writer.add(*material, colors.translucent);
      made.model.meshes[0].primitives[made.material_names.size()].material = number;
    }
    made.material_names.push_back(material ? material->name : "");
  }
  return made;
}

}  // namespace lodestone::detail

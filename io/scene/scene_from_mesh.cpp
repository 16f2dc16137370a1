// A scene of what is no glTF: one mesh, its materials as glTF's, their images inside.

#include <algorithm>
#include <map>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/scene.h>

#include "scene/scene_impl.h"
#include "scene/scene_mesh.h"
#include "scene/scene_places.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr int kClampToEdge = 33071;
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

/// Writes a document's materials with the textures, samplers and images that they use.
class MaterialWriter {
 public:
  MaterialWriter(Json& document, MeshFile& file, std::vector<EmbeddedImage>& images)
      : document_(document), file_(file), images_(images) {}

  /// Returns the material's number in the document.
  std::size_t add(const Material& material, bool translucent) {
    Json surface = {{"metallicFactor", material.metallic}, {"roughnessFactor", material.roughness}};
    if (material.base_color != std::array<float, 4>{1, 1, 1, 1}) surface["baseColorFactor"] = material.base_color;
    set_texture(surface, "baseColorTexture", material.base_color_texture);
    set_texture(surface, "metallicRoughnessTexture", material.metallic_roughness_texture);
    Json json = Json::object();
    if (!material.name.empty()) json["name"] = material.name;
    json["pbrMetallicRoughness"] = std::move(surface);
    set_texture(json, "normalTexture", material.normal_texture);
    if (material.normal_texture && material.normal_scale != 1) json["normalTexture"]["scale"] = material.normal_scale;
    set_texture(json, "emissiveTexture", material.emissive_texture);
    set_emission(json, material.emissive);
    if (material.translucent || translucent) json["alphaMode"] = "BLEND";
    return push("materials", std::move(json));
  }

 private:
  std::size_t push(const char* array, Json object) {
    document_[array].push_back(std::move(object));
    return document_[array].size() - 1;
  }

  void use_extension(const char* name) {
    Json& used = document_["extensionsUsed"];
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
  }

  void set_texture(Json& owner, const char* key, const std::optional<Texture>& texture) {
    if (!texture) return;
    Json info = {{"index", texture_number(*texture)}};
    Json transform = Json::object();
    if (texture->offset != std::array<float, 2>{0, 0}) transform["offset"] = texture->offset;
    if (texture->scale != std::array<float, 2>{1, 1}) transform["scale"] = texture->scale;
    if (!transform.empty()) {
      info["extensions"][kTextureTransform] = std::move(transform);
      use_extension(kTextureTransform);
    }
    owner[key] = std::move(info);
  }

  std::size_t texture_number(const Texture& texture) {
    const auto [entry, is_new] = textures_.try_emplace({texture.image, texture.clamp});
    if (!is_new) return entry->second;
    Json json = {{"source", image_number(texture.image)}};
    if (texture.clamp) json["sampler"] = push("samplers", {{"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}});
    return entry->second = push("textures", std::move(json));
  }

  std::size_t image_number(std::size_t number) {
    const auto [entry, is_new] = image_numbers_.try_emplace(number);
    if (!is_new) return entry->second;
    Image& image = file_.images[number];
    entry->second = push("images", {{"name", std::filesystem::path(image.name).filename().string()}});
    images_.push_back({entry->second, std::move(image.mime_type), std::move(image.bytes)});
    return entry->second;
  }

  void set_emission(Json& json, std::array<float, 3> emissive) {
    const float strength = *std::max_element(emissive.begin(), emissive.end());
    if (!(strength > 0)) return;
    if (strength > 1) {
      for (float& component : emissive) component /= strength;
      json["extensions"][kEmissiveStrength] = {{"emissiveStrength", strength}};
      use_extension(kEmissiveStrength);
    }
    json["emissiveFactor"] = emissive;
  }

  Json& document_;
  MeshFile& file_;
  std::vector<EmbeddedImage>& images_;
  std::map<std::pair<std::size_t, bool>, std::size_t> textures_;
  std::map<std::size_t, std::size_t> image_numbers_;
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

Json document_of(const std::string& name, std::size_t primitive_count) {
  Json document = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  document["scenes"] = Json::array({Json{{"nodes", Json::array({0})}}});
  Json node = Json::object(), mesh = Json::object();
  if (!name.empty()) node["name"] = mesh["name"] = name;
  if (primitive_count > 0) node["mesh"] = 0;
  document["nodes"] = Json::array({std::move(node)});
  if (primitive_count == 0) return document;
  mesh["primitives"] = Json::array();
  for (std::size_t i = 0; i < primitive_count; ++i) mesh["primitives"].push_back({{"attributes", Json::object()}});
  document["meshes"] = Json::array({std::move(mesh)});
  return document;
}

Result<GltfDocument> parse(const Json& document) {
  const std::string json = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  return GltfDocument::parse(std::as_bytes(std::span(json)), [](const std::filesystem::path& relative) {
    return Result<std::vector<std::byte>>(fail(ErrorCode::Unreadable, text("'", relative, "' is not there")));
  });
}

}  // namespace

Result<Scene> Scene::from_mesh(MeshFile file, const std::string& name) {
  auto scene = std::make_shared<Impl>();
  const std::vector<Index> numbers = number_primitives(file.mesh);
  Json document = document_of(name, numbers.size());
  SceneMesh mesh;
  const VertexColors colors = look_at_colors(file.mesh);
  const auto materials = materials_of(file, numbers, colors);
  MaterialWriter writer(document, file, scene->images);
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (materials[i])
      document["meshes"][0]["primitives"][i]["material"] = writer.add(*materials[i], colors.translucent);
    mesh.materials.push_back(materials[i] ? materials[i]->name : "");
  }
  LODESTONE_TRY(scene->document, parse(document));
  scene->notes = std::move(file.notes);
  if (numbers.empty()) {
    scene->dropped.push_back(file.assembly);
    return Scene(std::move(scene));
  }
  MeshSource source = source_of(file.mesh, numbers.size());
  source.nodes = {0};
  mesh.name = name;
  mesh.mesh = std::move(file.mesh);
  mesh.assembly = file.assembly;
  scene->meshes.push_back(std::move(mesh));
  scene->sources.push_back(std::move(source));
  LODESTONE_CHECK(measure_instances(*scene));
  return Scene(std::move(scene));
}

}  // namespace lodestone

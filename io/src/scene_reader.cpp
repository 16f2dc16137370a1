#include <map>
#include <set>

#include <lodestone/io/file.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>

#include "gltf_flatten.h"
#include "gltf_scene.h"
#include "scene_images.h"
#include "scene_impl.h"
#include "scene_mesh.h"
#include "scene_places.h"
#include "scene_undo.h"
#include "stream_extension.h"
#include "text.h"
#include "try.h"

namespace lodestone {
namespace {

using namespace detail;

Result<std::vector<std::byte>> nothing_beside(const std::filesystem::path& relative) {
  return fail(ErrorCode::Unreadable, text("'", relative, "' lies outside the bytes given"));
}

Error with_path(Error error, const std::filesystem::path& path) {
  error.message = text('\'', path, "': ", error.message);
  return error;
}

Result<void> refuse_levels(const GltfDocument& document) {
  LODESTONE_TRY(const auto chains, lod_chains(document));
  if (chains.empty()) return {};
  return fail(ErrorCode::Unsupported,
              text("node ", chains[0][0], " already has levels of detail (MSFT_lod); build from the original"));
}

/// Returns the nodes that show each mesh in a scene.
Result<std::map<std::size_t, std::vector<std::size_t>>> find_shown_meshes(const GltfDocument& document) {
  std::map<std::size_t, std::vector<std::size_t>> nodes_of;
  LODESTONE_TRY(const auto places, place_nodes(document));
  for (std::size_t i = 0; i < places.size(); ++i) {
    LODESTONE_TRY(const Json* const node, document.element("nodes", "node", i));
    if (!places[i].shown || find_member(*node, "mesh") == nullptr) continue;
    LODESTONE_TRY(const std::size_t mesh, size_member(*node, "mesh", text("node ", i)));
    nodes_of[mesh].push_back(i);
  }
  return nodes_of;
}

Result<std::vector<std::byte>> read_stream(const GltfDocument& document, std::size_t mesh) {
  LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", mesh));
  const Json* extension = GltfDocument::extension(*json, kStreamExtension);
  if (extension == nullptr) return std::vector<std::byte>{};
  LODESTONE_TRY(const std::size_t view_index, size_member(*extension, "bufferView", kStreamExtension));
  LODESTONE_TRY(const BufferView view, document.buffer_view(view_index));
  return std::vector<std::byte>(view.bytes.begin(), view.bytes.end());
}

/// Reads a mesh's stream. What a grid left no area of the levels, the stream still has.
Result<void> add_stream(const GltfDocument& document, std::size_t number, SceneMesh& mesh) {
  LODESTONE_TRY(mesh.stream, read_stream(document, number));
  if (mesh.stream.empty() || mesh.mesh.face_count() > 0) return {};
  LODESTONE_TRY(const ProgressiveMesh whole, decode_stream(mesh.stream));
  Cursor cursor(whole);
  cursor.seek(static_cast<Index>(whole.record_count()));
  mesh.mesh = extract_level(whole, cursor);
  return {};
}

const char* why_empty(const GltfDocument& document) {
  if (document.count("meshes") == 0) return "the file has no meshes";
  if (document.count("nodes") == 0) return "the file has no nodes to show its meshes";
  return "no node of a scene shows a mesh with triangles";
}

Result<void> read_meshes(Scene::Impl& scene, bool with_streams) {
  LODESTONE_TRY(const auto nodes_of, find_shown_meshes(scene.document));
  for (const auto& [number, nodes] : nodes_of) {
    LODESTONE_TRY(auto joined, join_primitives(scene.document, number));
    if (!joined) continue;
    if (with_streams) LODESTONE_CHECK(add_stream(scene.document, number, joined->mesh));
    if (joined->mesh.mesh.face_count() == 0) {
      scene.dropped.push_back(joined->mesh.assembly);
      continue;
    }
    joined->source.nodes = nodes;
    for (const std::string& name : joined->left_out)
      scene.notes.push_back(
          text("mesh ", number, ": attribute ", name, " is left out: glTF vertices have no such type"));
    scene.meshes.push_back(std::move(joined->mesh));
    scene.sources.push_back(std::move(joined->source));
  }
  if (scene.meshes.empty() && scene.dropped.empty()) scene.notes.push_back(why_empty(scene.document));
  return measure_instances(scene);
}

enum class Levels { Refused, TakenOut };

Result<Scene> read_gltf_scene(std::span<const std::byte> bytes, const FileFetcher& fetch, Levels levels) {
  auto scene = std::make_shared<Scene::Impl>();
  LODESTONE_TRY(scene->document, GltfDocument::parse(bytes, fetch));
  LODESTONE_CHECK(check_required_extensions(scene->document, "EXT_mesh_gpu_instancing"));
  if (levels == Levels::Refused) {
    LODESTONE_CHECK(refuse_levels(scene->document));
  } else {
    LODESTONE_CHECK(take_out_levels(*scene));
  }
  LODESTONE_CHECK(read_meshes(*scene, levels == Levels::TakenOut));
  scene->images = fetch_images(scene->document, fetch, scene->notes);
  return Scene(std::move(scene));
}

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

Json placeholder_document(const std::string& name, std::span<const Index> materials) {
  Json document = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  document["scenes"] = Json::array({Json{{"nodes", Json::array({0})}}});
  Json node = Json::object(), mesh = Json::object();
  if (!name.empty()) node["name"] = mesh["name"] = name;
  if (!materials.empty()) node["mesh"] = 0;
  document["nodes"] = Json::array({std::move(node)});
  if (materials.empty()) return document;
  for (const Index number : materials) {
    Json primitive = {{"attributes", Json::object()}};
    if (number != 0) {
      primitive["material"] = document.contains("materials") ? document["materials"].size() : 0;
      document["materials"].push_back({{"name", text("material ", number)},
                                       {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.8}}}});
    }
    mesh["primitives"].push_back(std::move(primitive));
  }
  document["meshes"] = Json::array({std::move(mesh)});
  return document;
}

}  // namespace

Result<Scene> Scene::from_mesh(MeshFile file, const std::string& name) {
  auto scene = std::make_shared<Impl>();
  const std::vector<Index> materials = number_primitives(file.mesh);
  const std::string json = placeholder_document(name, materials).dump(-1, ' ', false, Json::error_handler_t::replace);
  LODESTONE_TRY(scene->document, GltfDocument::parse(std::as_bytes(std::span(json)), nothing_beside));
  scene->notes = std::move(file.notes);
  if (materials.empty()) {
    scene->dropped.push_back(file.assembly);
    return Scene(std::move(scene));
  }
  MeshSource source = source_of(file.mesh, materials.size());
  source.nodes = {0};
  SceneMesh mesh;
  mesh.name = name;
  for (const Index number : materials) mesh.materials.push_back(number == 0 ? "" : text("material ", number));
  mesh.mesh = std::move(file.mesh);
  mesh.assembly = file.assembly;
  scene->meshes.push_back(std::move(mesh));
  scene->sources.push_back(std::move(source));
  LODESTONE_CHECK(measure_instances(*scene));
  return Scene(std::move(scene));
}

Result<Scene> Scene::read(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  if (!is_gltf(bytes, extension_of(path))) {
    auto file = read_mesh_bytes(bytes, extension_of(path));
    if (!file) return tl::unexpected<Error>(with_path(std::move(file).error(), path));
    return from_mesh(std::move(*file), path.stem().string());
  }
  const auto fetch = [&](const std::filesystem::path& relative) { return read_file(path.parent_path() / relative); };
  return read_gltf_scene(bytes, fetch, Levels::Refused).map_error([&](Error error) {
    return with_path(std::move(error), path);
  });
}

Result<Scene> Scene::read_bytes(std::span<const std::byte> bytes, const std::string& extension) {
  if (is_gltf(bytes, extension)) return read_gltf_scene(bytes, nothing_beside, Levels::Refused);
  LODESTONE_TRY(MeshFile file, read_mesh_bytes(bytes, extension));
  return from_mesh(std::move(file), "mesh");
}

Result<Scene> Scene::read_multi_lod(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  return read_multi_lod_bytes(bytes).map_error([&](Error error) { return with_path(std::move(error), path); });
}

Result<Scene> Scene::read_multi_lod_bytes(std::span<const std::byte> bytes) {
  return read_gltf_scene(bytes, nothing_beside, Levels::TakenOut);
}

const std::vector<SceneMesh>& Scene::meshes() const { return impl_->meshes; }
const std::vector<AssemblyReport>& Scene::dropped() const { return impl_->dropped; }
const std::vector<std::string>& Scene::notes() const { return impl_->notes; }
const Box& Scene::box() const { return impl_->box; }

}  // namespace lodestone

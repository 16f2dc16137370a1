#include <map>
#include <set>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/cursor.h>

#include "base/files_beside.h"
#include "formats/read_mesh_bytes.h"
#include "gltf/gltf_flatten.h"
#include "gltf/gltf_scene.h"
#include "mesh/float_spacing.h"
#include "scene/scene_images.h"
#include "scene/scene_impl.h"
#include "scene/scene_mesh.h"
#include "scene/scene_places.h"
#include "scene/scene_reader.h"
#include "scene/scene_undo.h"
#include "scene/stream_extension.h"

namespace lodestone {
namespace {

using namespace detail;

Result<void> refuse_levels(const GltfDocument& document) {
  for (std::size_t mesh = 0; mesh < document.count("meshes"); ++mesh) {
    if (shows_level_of_stream(document.list("meshes")[mesh]))
      return fail(ErrorCode::Unsupported, text("mesh ", mesh, " is a level of what its stream (", kStreamExtension,
                                               ") refines it to; build from the original"));
  }
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

/// Reads a mesh's stream. What a grid left no area of the levels, the stream still has.
Result<void> add_stream(const GltfDocument& document, std::size_t number, const FileFetcher& fetch, SceneMesh& mesh) {
  LODESTONE_TRY(mesh.stream, stored_stream(document, number, fetch));
  if (mesh.stream.empty() || mesh.mesh.face_count() > 0) return {};
  LODESTONE_TRY(const ProgressiveMesh whole, read_stream(mesh.stream));
  mesh.mesh = extract_level(whole, static_cast<Index>(whole.record_count()));
  return {};
}

const char* why_empty(const GltfDocument& document) {
  if (document.count("meshes") == 0) return "the file has no meshes";
  if (document.count("nodes") == 0) return "the file has no nodes to show its meshes";
  return "no node of a scene shows a mesh with triangles";
}

Result<void> read_meshes(Scene::Impl& scene, const FileFetcher& fetch, bool with_streams) {
  LODESTONE_TRY(const auto nodes_of, find_shown_meshes(scene.document));
  for (const auto& [number, nodes] : nodes_of) {
    LODESTONE_TRY(auto joined, join_primitives(scene.document, number));
    if (!joined) continue;
    if (with_streams) LODESTONE_CHECK(add_stream(scene.document, number, fetch, joined->mesh));
    if (joined->mesh.mesh.face_count() == 0) {
      scene.dropped.push_back(joined->mesh.assembly);
      continue;
    }
    joined->source.nodes = nodes;
    for (const std::string& name : joined->left_out)
      scene.notes.push_back(
          text("mesh ", number, ": attribute ", name, " is left out: glTF vertices have no such type"));
    if (const auto note = coarse_floats(joined->mesh.mesh)) scene.notes.push_back(text("mesh ", number, ": ", *note));
    scene.meshes.push_back(std::move(joined->mesh));
    scene.sources.push_back(std::move(joined->source));
  }
  if (scene.meshes.empty() && scene.dropped.empty()) scene.notes.push_back(why_empty(scene.document));
  return measure_instances(scene);
}

/// Fetches files, and lists those that there were.
FileFetcher listing(const FileFetcher& fetch, std::vector<std::filesystem::path>& files) {
  return [&fetch, &files](const std::filesystem::path& relative) {
    auto file = fetch(relative);
    if (file) files.push_back(relative);
    return file;
  };
}

std::shared_ptr<Scene::Impl> begin_scene(OpenedGltf& gltf) {
  auto scene = std::make_shared<Scene::Impl>();
  scene->in_metres = true;
  scene->document = std::move(gltf.document);
  scene->files = std::move(gltf.files);
  return scene;
}

Result<Scene> finish_scene(std::shared_ptr<Scene::Impl> scene, const FileFetcher& fetch, bool with_streams) {
  LODESTONE_CHECK(read_meshes(*scene, listing(fetch, scene->files), with_streams));
  fetch_images(scene->document, listing(fetch, scene->files), scene->images, scene->notes);
  return Scene(std::move(scene));
}

Result<Scene> read_gltf_scene(std::span<const std::byte> bytes, FileFetcher fetch) {
  LODESTONE_TRY(OpenedGltf gltf, open_gltf(bytes, std::move(fetch)));
  return scene_of(std::move(gltf), {});
}

}  // namespace

Result<OpenedGltf> detail::open_gltf(std::span<const std::byte> bytes, FileFetcher fetch) {
  OpenedGltf gltf;
  gltf.fetch = std::move(fetch);
  LODESTONE_TRY(gltf.document, GltfDocument::parse(bytes, listing(gltf.fetch, gltf.files)));
  LODESTONE_CHECK(check_required_extensions(gltf.document));
  return gltf;
}

Result<Scene> detail::scene_of(OpenedGltf gltf, std::vector<EmbeddedImage> images) {
  LODESTONE_CHECK(refuse_levels(gltf.document));
  auto scene = begin_scene(gltf);
  scene->images = std::move(images);
  return finish_scene(std::move(scene), gltf.fetch, false);
}

Result<Scene> detail::scene_of_level(OpenedGltf gltf, std::size_t level) {
  auto scene = begin_scene(gltf);
  LODESTONE_CHECK(take_out_levels(*scene, level));
  return finish_scene(std::move(scene), gltf.fetch, level == 0);
}

Result<Scene> Scene::read(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  if (!is_gltf(bytes, extension_of(path))) {
    auto file = detail::read_mesh_bytes(bytes, extension_of(path), files_beside(path));
    if (!file) return tl::unexpected<Error>(with_path(std::move(file).error(), path));
    return from_mesh(std::move(*file), path.stem().string());
  }
  return read_gltf_scene(bytes, files_beside(path)).map_error([&](Error error) {
    return with_path(std::move(error), path);
  });
}

Result<Scene> Scene::read_bytes(std::span<const std::byte> bytes, const std::string& extension) {
  if (is_gltf(bytes, extension)) return read_gltf_scene(bytes, nothing_beside);
  LODESTONE_TRY(MeshFile file, read_mesh_bytes(bytes, extension));
  return from_mesh(std::move(file), "mesh");
}

const std::vector<SceneMesh>& Scene::meshes() const { return impl_->meshes; }
const std::vector<AssemblyReport>& Scene::dropped() const { return impl_->dropped; }
const std::vector<std::string>& Scene::notes() const { return impl_->notes; }
const Box& Scene::box() const { return impl_->box; }
bool Scene::in_metres() const { return impl_->in_metres; }
const std::vector<std::filesystem::path>& Scene::files() const { return impl_->files; }

}  // namespace lodestone

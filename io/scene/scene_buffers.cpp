#include "scene/scene_buffers.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "scene/stream_extension.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kKeptAlignment = 8;  // what the widest known content of extensions asks for

/// Who uses the objects of an array. What nobody known uses is kept.
struct Uses {
  std::vector<bool> replaced, kept;

  explicit Uses(std::size_t count) : replaced(count), kept(count) {}
  void add(const Json* index, bool is_replaced) {
    const auto number = index != nullptr ? as_size(*index) : std::nullopt;
    if (number && *number < kept.size()) (is_replaced ? replaced : kept)[*number] = true;
  }
  bool dead(std::size_t number) const { return replaced[number] && !kept[number]; }
};

/// Looks through all objects that are known to name accessors or bufferViews; odd ones are passed over, since nothing
/// here reads what they name.
class UseFinder {
 public:
  explicit UseFinder(const Scene::Impl& scene)
      : scene_(scene),
        json_(scene.document.json()),
        accessors_(scene.document.count("accessors")),
        views_(scene.document.count("bufferViews")) {}

  BufferPlan run(bool images_leave) {
    add_meshes();
    add_animations();
    for_each(json_, "skins",
             [&](const Json& skin) { accessors_.add(find_member(skin, "inverseBindMatrices"), false); });
    add_instancing();
    add_views_of_accessors();
    for_each(json_, "images", [&](const Json& image) { views_.add(find_member(image, "bufferView"), images_leave); });
    return plan();
  }

 private:
  template <class Visit>
  static void for_each(const Json& object, const char* array, const Visit& visit) {
    const Json* list = find_member(object, array);
    if (list == nullptr || !list->is_array()) return;
    for (const Json& item : *list) visit(item);
  }

  template <class Visit>
  static void for_each_member(const Json* object, const Visit& visit) {
    if (object == nullptr || !object->is_object()) return;
    for (const auto& [name, value] : object->items()) visit(value);
  }

  void add_meshes() {
    std::vector<const MeshSource*> source_of(scene_.document.count("meshes"));
    for (const MeshSource& source : scene_.sources) source_of[source.mesh] = &source;
    for (std::size_t mesh = 0; mesh < source_of.size(); ++mesh) add_mesh(json_["meshes"][mesh], source_of[mesh]);
    for (const Json& mesh : scene_.dropped_meshes)
      for_each(mesh, "primitives", [&](const Json& primitive) { add_primitive(primitive, true); });
  }

  void add_mesh(const Json& mesh, const MeshSource* source) {
    std::size_t number = 0;
    for_each(mesh, "primitives", [&](const Json& primitive) {
      add_primitive(primitive, source != nullptr && source->primitives[number++].replaced);
    });
    // A stream belongs to the mesh as it was.
    if (const Json* stream = GltfDocument::extension(mesh, kStreamExtension))
      views_.add(find_member(*stream, "bufferView"), source != nullptr);
  }

  void add_primitive(const Json& primitive, bool replaced) {
    const auto add = [&](const Json& index) { accessors_.add(&index, replaced); };
    for_each_member(find_member(primitive, "attributes"), add);
    for_each(primitive, "targets", [&](const Json& target) { for_each_member(&target, add); });
    accessors_.add(find_member(primitive, "indices"), replaced);
    if (const Json* draco = GltfDocument::extension(primitive, kDraco))
      views_.add(find_member(*draco, "bufferView"), replaced);
  }

  void add_animations() {
    for_each(json_, "animations", [&](const Json& animation) {
      for_each(animation, "samplers", [&](const Json& sampler) {
        accessors_.add(find_member(sampler, "input"), false);
        accessors_.add(find_member(sampler, "output"), false);
      });
    });
  }

  void add_instancing() {
    for_each(json_, "nodes", [&](const Json& node) {
      if (const Json* extension = GltfDocument::extension(node, "EXT_mesh_gpu_instancing"))
        for_each_member(find_member(*extension, "attributes"),
                        [&](const Json& index) { accessors_.add(&index, false); });
    });
  }

  void add_views_of_accessors() {
    for (std::size_t i = 0; i < accessors_.kept.size(); ++i) {
      const Json& accessor = json_["accessors"][i];
      const bool dead = accessors_.dead(i);
      views_.add(find_member(accessor, "bufferView"), dead);
      const Json* sparse = find_member(accessor, "sparse");
      if (sparse == nullptr) continue;
      for (const char* part : {"indices", "values"})
        if (const Json* object = find_member(*sparse, part)) views_.add(find_member(*object, "bufferView"), dead);
    }
  }

  BufferPlan plan() const {
    BufferPlan plan;
    for (std::size_t i = 0; i < accessors_.kept.size(); ++i)
      if (accessors_.dead(i)) plan.free_slots["accessors"].push_back(i);
    for (std::size_t i = 0; i < views_.kept.size(); ++i) {
      if (views_.dead(i))
        plan.free_slots["bufferViews"].push_back(i);
      else
        plan.kept_views.push_back(i);
    }
    return plan;
  }

  const Scene::Impl& scene_;
  const Json& json_;
  Uses accessors_, views_;
};

/// A kept view's place in the document's buffers.
struct PlacedView {
  std::size_t view = 0;
  std::size_t buffer = 0;
  std::size_t offset = 0;
  std::span<const std::byte> bytes;
};

bool is_compressed(const Json& view) {
  return GltfDocument::extension(view, "EXT_meshopt_compression") != nullptr ||
         GltfDocument::extension(view, "KHR_meshopt_compression") != nullptr;
}

void set_place(Json& view, std::uint64_t offset, std::size_t size) {
  view["buffer"] = 0;
  view["byteOffset"] = offset;
  view["byteLength"] = size;
}

/// Copies views that overlap in one piece. Pre: they are sorted by place.
void copy_overlapping(std::span<const PlacedView> views, GlbBuilder& builder) {
  for (std::size_t first = 0; first < views.size();) {
    const std::size_t begin = views[first].offset;
    std::size_t end = begin + views[first].bytes.size(), next = first + 1;
    for (; next < views.size() && views[next].buffer == views[first].buffer && views[next].offset < end; ++next)
      end = std::max(end, views[next].offset + views[next].bytes.size());
    const std::span<const std::byte> piece(views[first].bytes.data(), end - begin);
    const std::uint64_t offset = builder.add_bytes(piece, kKeptAlignment, begin % kKeptAlignment);
    for (; first < next; ++first)
      set_place(builder.at("bufferViews", views[first].view), offset + (views[first].offset - begin),
                views[first].bytes.size());
  }
}

}  // namespace

BufferPlan plan_buffers(const Scene::Impl& scene, bool images_leave) { return UseFinder(scene).run(images_leave); }

Result<void> copy_kept_views(const GltfDocument& document, const BufferPlan& plan, GlbBuilder& builder) {
  std::vector<PlacedView> plain;
  for (const std::size_t index : plan.kept_views) {
    LODESTONE_TRY(const BufferView view, document.buffer_view(index));
    Json& json = builder.at("bufferViews", index);
    if (is_compressed(json)) {
      set_place(json, builder.add_bytes(view.bytes, kKeptAlignment), view.bytes.size());
      erase_extension(json, "EXT_meshopt_compression");
      erase_extension(json, "KHR_meshopt_compression");
      continue;
    }
    const std::string where = text("buffer view ", index);
    LODESTONE_TRY(const std::size_t buffer, size_member(json, "buffer", where));
    LODESTONE_TRY(const std::size_t offset, size_member_or(json, "byteOffset", 0, where));
    plain.push_back({index, buffer, offset, view.bytes});
  }
  std::sort(plain.begin(), plain.end(), [](const PlacedView& a, const PlacedView& b) {
    return std::tie(a.buffer, a.offset, a.view) < std::tie(b.buffer, b.offset, b.view);
  });
  copy_overlapping(plain, builder);
  return {};
}

void embed_images(const std::vector<EmbeddedImage>& images, GlbBuilder& builder) {
  for (const EmbeddedImage& embedded : images) {
    const std::size_t view = builder.add_view(embedded.bytes);
    Json& image = builder.at("images", embedded.image);
    image.erase("uri");
    image["mimeType"] = embedded.mime_type;
    image["bufferView"] = view;
  }
}

void erase_extension(Json& object, const char* name) {
  const Json* extensions = find_member(object, "extensions");
  if (extensions == nullptr || !extensions->is_object()) return;
  object["extensions"].erase(name);
  if (object["extensions"].empty()) object.erase("extensions");
}

}  // namespace lodestone::detail

#include "scene/scene_files.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "gltf/gltf_container.h"

namespace lodestone::detail {
namespace {

bool is_plain_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

/// The part of "image/png" that names a file's extension.
std::string extension_for(std::string_view mime_type) {
  if (mime_type == "image/jpeg") return ".jpg";
  const std::string_view kind = mime_type.substr(std::min(mime_type.find('/') + 1, mime_type.size()));
  const bool plain = !kind.empty() && std::all_of(kind.begin(), kind.end(), is_plain_letter);
  return plain ? text('.', kind) : ".img";
}

/// Gives names to files, none of them twice.
class FileNames {
 public:
  explicit FileNames(std::string name) : name_(std::move(name)), taken_{name_ + ".gltf", name_ + ".bin"} {}

  /// Takes a path unless it is taken.
  bool take(const std::string& path) { return taken_.insert(path).second; }

  /// Names the file of an image that has none.
  std::string invent(const Json& image, std::size_t number, const std::string& extension) {
    const std::string own = string_member(image, "name");
    const bool usable =
        !own.empty() && own.size() <= 100 && own[0] != '.' && std::all_of(own.begin(), own.end(), is_plain_letter);
    std::string stem = usable ? own : text(name_, "_image", number);
    if (stem.ends_with(extension)) stem.resize(stem.size() - extension.size());
    if (take(stem + extension)) return stem + extension;
    for (int serial = 2;; ++serial)
      if (std::string path = text(stem, '_', serial, extension); take(path)) return path;
  }

 private:
  std::string name_;
  std::set<std::string> taken_;
};

/// Returns the bytes of images that lie in buffers.
Result<std::vector<EmbeddedImage>> buffered_images(const GltfDocument& document) {
  std::vector<EmbeddedImage> images;
  for (std::size_t i = 0; i < document.count("images"); ++i) {
    const Json& image = document.list("images")[i];
    if (find_member(image, "bufferView") == nullptr) continue;
    LODESTONE_TRY(const std::size_t index, size_member(image, "bufferView", text("image ", i)));
    LODESTONE_TRY(const BufferView view, document.buffer_view(index));
    images.push_back({i, string_member(image, "mimeType"), {view.bytes.begin(), view.bytes.end()}});
  }
  return images;
}

/// Returns where an image lay beside the document; empty for one in a data URI or a buffer.
std::string place_of(const Json& image) {
  const std::string uri = string_member(image, "uri");
  if (uri.empty() || uri.starts_with("data:")) return "";
  const auto path = uri_to_path(uri, "image");
  return path ? path->lexically_normal().generic_string() : "";
}

}  // namespace

std::string uri_of(const std::filesystem::path& relative) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  std::string uri;
  for (const char c : relative.generic_string()) {
    if (is_plain_letter(c) || c == '/' || c == '~') {
      uri += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      uri.append({'%', kDigits[byte / 16], kDigits[byte % 16]});
    }
  }
  return uri;
}

Result<std::vector<AssetFile>> put_images_beside(const Scene::Impl& scene, const std::string& name,
                                                 GlbBuilder& builder) {
  LODESTONE_TRY(std::vector<EmbeddedImage> images, buffered_images(scene.document));
  images.insert(images.end(), scene.images.begin(), scene.images.end());
  FileNames names(name);
  std::vector<AssetFile> files;
  const auto add = [&](EmbeddedImage& image, const std::string& path, bool is_new) {
    Json& object = builder.at("images", image.image);
    object.erase("bufferView");
    object["uri"] = uri_of(path);
    if (is_new) files.push_back({path, std::move(image.bytes)});
  };
  std::vector<EmbeddedImage*> homeless;
  std::set<std::string> kept;  // images of one file share it
  for (EmbeddedImage& image : images) {
    const std::string place = place_of(scene.document.list("images")[image.image]);
    if (place.empty() || (!kept.contains(place) && !names.take(place))) {
      homeless.push_back(&image);
    } else {
      add(image, place, kept.insert(place).second);
    }
  }
  for (EmbeddedImage* image : homeless)
    add(*image, names.invent(builder.at("images", image->image), image->image, extension_for(image->mime_type)), true);
  return files;
}

}  // namespace lodestone::detail

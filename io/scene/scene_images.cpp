#include "scene/scene_images.h"

#include <set>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/files_beside.h"
#include "gltf/gltf_container.h"
#include "mesh/image_file.h"

namespace lodestone::detail {
namespace {

/// Goes by the content, since extensions and declared types are often wrong; else by what the document declares, and
/// data URIs where they name an image's type.
std::string mime_type_of(std::span<const std::byte> bytes, const Json& image, const std::string& uri) {
  std::string type = image_type(bytes);
  if (type.empty()) type = string_member(image, "mimeType");
  if (type.empty() && uri.starts_with("data:image/")) type = uri.substr(5, uri.find_first_of(";,") - 5);
  return type;
}

Result<EmbeddedImage> fetch_image(const Json& image, const std::string& uri, const FileFetcher& fetch) {
  EmbeddedImage embedded;
  if (uri.starts_with("data:")) {
    LODESTONE_TRY(embedded.bytes, decode_data_uri(uri, "image"));
  } else {
    LODESTONE_TRY(const std::filesystem::path path, uri_to_path(uri, "image"));
    LODESTONE_TRY(embedded.bytes, fetch(path));
  }
  embedded.mime_type = mime_type_of(embedded.bytes, image, uri);
  if (embedded.bytes.empty() || embedded.mime_type.empty())
    return fail(ErrorCode::Unsupported, "no known format of images");
  return embedded;
}

std::string shortened(const std::string& uri) { return uri.size() <= 60 ? uri : uri.substr(0, 57) + "..."; }

}  // namespace

void fetch_images(const GltfDocument& document, const FileFetcher& fetch, std::vector<EmbeddedImage>& images,
                  std::vector<std::string>& notes) {
  std::set<std::size_t> known;
  for (const EmbeddedImage& image : images) known.insert(image.image);
  for (std::size_t i = 0; i < document.count("images"); ++i) {
    const Json& image = document.list("images")[i];
    const std::string uri = string_member(image, "uri");
    if (uri.empty() || known.contains(i)) continue;
    auto embedded = fetch_image(image, uri, fetch);
    if (!embedded) {
      notes.push_back(
          text("image ", i, " stays outside the file, at '", shortened(uri), "': ", embedded.error().message));
      continue;
    }
    embedded->image = i;
    images.push_back(std::move(*embedded));
  }
}

}  // namespace lodestone::detail

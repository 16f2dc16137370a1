// Models of tinygltf, into scenes and out of assets. Both ways lead over the bytes of a file: what a program's model or
// an asset says is checked by the reader that checks files.

#include <lodestone/io/tinygltf_model.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <map>
#include <new>
#include <span>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "gltf/gltf_container.h"
#include "gltf/gltf_document.h"
#include "mesh/image_file.h"
#include "model/tinygltf.h"
#include "model/write_model.h"
#include "scene/scene_reader.h"

namespace lodestone {
namespace {

using namespace detail;

std::span<const std::byte> as_bytes_of(const std::vector<unsigned char>& data) {
  return std::as_bytes(std::span(data));
}

/// Lists the images that have their files' bytes and no bufferView.
Result<std::vector<EmbeddedImage>> images_of(const tinygltf::Model& model) {
  std::vector<EmbeddedImage> images;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const tinygltf::Image& image = model.images[i];
    if (image.bufferView >= 0) continue;
    if (image.as_is && !image.image.empty()) {
      const auto bytes = as_bytes_of(image.image);
      const std::string found = image_type(bytes);
      images.push_back({i, found.empty() ? image.mimeType : found, {bytes.begin(), bytes.end()}});
      if (images.back().mime_type.empty())
        return fail(ErrorCode::Unsupported, text("image ", i, ": no known format of images"));
    } else if (image.uri.empty()) {
      return fail(ErrorCode::Unsupported,
                  text("image ", i, ": the model has no file of it; have tinygltf load images as they are (as_is)"));
    }
  }
  return images;
}

/// tinygltf does not write what tells that a bufferView is compressed.
Result<void> refuse_meshopt(const tinygltf::Model& model) {
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i)
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (model.bufferViews[i].extensions.contains(name))
        return fail(ErrorCode::Unsupported, text("buffer view ", i, ": tinygltf does not write ", name));
  return {};
}

using FilesByUri = std::map<std::string, const std::vector<std::byte>*>;

FilesByUri files_of(const EncodedAsset& asset) {
  FilesByUri files;
  for (const AssetFile& file : asset.beside) files[file.path.generic_string()] = &file.bytes;
  return files;
}

const std::vector<std::byte>* find_file(const FilesByUri& files, const std::string& path) {
  const auto found = files.find(path);
  return found == files.end() ? nullptr : found->second;
}

/// tinygltf 2.7 reads images where an asset says, checked or not; what is in Draco it does not decode.
Result<void> check_asset(const EncodedAsset& asset, const FilesByUri& files) {
  const auto fetch = [&](const std::filesystem::path& relative) -> Result<std::vector<std::byte>> {
    if (const auto* bytes = find_file(files, relative.generic_string())) return *bytes;
    return nothing_beside(relative);
  };
  LODESTONE_TRY(const GltfDocument document, GltfDocument::parse(asset.glb, fetch));
  for (std::size_t i = 0; i < document.count("images"); ++i) {
    const Json& image = document.list("images")[i];
    if (find_member(image, "bufferView") == nullptr) continue;
    LODESTONE_TRY(const std::size_t view, size_member(image, "bufferView", text("image ", i)));
    LODESTONE_CHECK(document.buffer_view(view));
  }
  const Json* required = find_member(document.json(), "extensionsRequired");
  if (required == nullptr ||
      std::find(required->begin(), required->end(), "KHR_draco_mesh_compression") == required->end())
    return {};
  return fail(ErrorCode::Unsupported, "the asset's geometry is in Draco, of which a model would have nothing decoded");
}

bool keep_file(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
               void*) {
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

const std::vector<std::byte>* find_file(void* files, const std::string& path) {
  return find_file(*static_cast<const FilesByUri*>(files), path);
}

/// Has tinygltf find the files of a .gltf. Its versions differ in what they ask of a file system.
template <class Callbacks>
Callbacks callbacks_for(FilesByUri& files) {
  Callbacks callbacks{};
  callbacks.FileExists = [](const std::string& path, void* from) { return find_file(from, path) != nullptr; };
  callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
  callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& path, void* from) {
    const auto* bytes = find_file(from, path);
    if (bytes == nullptr) return false;
    const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
    out->assign(first, first + bytes->size());
    return true;
  };
  callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  if constexpr (requires { callbacks.GetFileSizeInBytes; })
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string& path, void* from) {
      const auto* bytes = find_file(from, path);
      if (bytes != nullptr) *size = bytes->size();
      return bytes != nullptr;
    };
  callbacks.user_data = &files;
  return callbacks;
}

Result<tinygltf::Model> load(std::span<const std::byte> bytes, FilesByUri& files) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_file, nullptr);
  loader.SetFsCallbacks(callbacks_for<tinygltf::FsCallbacks>(files));
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  const bool loaded = is_glb(bytes)
                          ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                                        reinterpret_cast<const unsigned char*>(bytes.data()), size)
                          : loader.LoadASCIIFromString(&model, &error, &warning, as_text(bytes).data(), size, "");
  if (loaded) return model;
  while (error.ends_with('\n')) error.pop_back();
  return fail(ErrorCode::Malformed, text("tinygltf: ", error));
}

/// Gives images beside a .gltf their bytes, which tinygltf may be built not to load.
void add_images_beside(const FilesByUri& files, tinygltf::Model& model) {
  for (tinygltf::Image& image : model.images) {
    if (!image.image.empty() || image.uri.empty()) continue;
    const auto path = uri_to_path(image.uri, "image");
    const auto* bytes = path ? find_file(files, path->generic_string()) : nullptr;
    if (bytes == nullptr) continue;
    const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
    keep_file(&image, 0, nullptr, nullptr, 0, 0, first, static_cast<int>(bytes->size()), nullptr);
  }
}

}  // namespace

Result<Scene> scene_from_model(const tinygltf::Model& model) {
  LODESTONE_CHECK(refuse_meshopt(model));
  LODESTONE_TRY(std::vector<EmbeddedImage> images, images_of(model));
  LODESTONE_TRY(const std::vector<std::byte> glb, write_model(model));
  LODESTONE_TRY(OpenedGltf gltf, open_gltf(glb, nothing_beside));
  return scene_of(std::move(gltf), std::move(images));
}

Result<tinygltf::Model> model_from_asset(const EncodedAsset& asset) {
  if (asset.glb.size() > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::LimitExceeded, text("glTF: ", asset.glb.size(), " bytes are more than tinygltf takes"));
  FilesByUri files = files_of(asset);
  LODESTONE_CHECK(check_asset(asset, files));
  try {
    LODESTONE_TRY(tinygltf::Model model, load(asset.glb, files));
    add_images_beside(files, model);
    return model;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return fail(ErrorCode::Malformed, text("tinygltf: ", error.what()));
  }
}

}  // namespace lodestone

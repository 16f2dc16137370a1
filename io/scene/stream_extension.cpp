#include "scene/stream_extension.h"

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_reader.h>

#include "base/bytes.h"
#include "gltf/gltf_container.h"

namespace lodestone::detail {

bool is_compact(std::span<const std::byte> stream) { return stream_version(stream) == kCompactStreamVersion; }

std::string version_text(std::span<const std::byte> stream) {
  constexpr std::size_t kMinorAt = 10;
  const bool has_minor = is_stream(stream) && stream.size() >= kMinorAt + sizeof(std::uint16_t);
  return text(stream_version(stream), ".", has_minor ? load<std::uint16_t>(stream, kMinorAt) : 0);
}

bool shows_level_of_stream(const Json& mesh) {
  const Json* extension = GltfDocument::extension(mesh, kStreamExtension);
  return extension != nullptr && find_member(*extension, "deviation") != nullptr &&
         string_member(*extension, "version").starts_with(text(kCompactStreamVersion, "."));
}

Result<std::vector<std::byte>> stored_stream(const GltfDocument& document, std::size_t mesh, const FileFetcher& fetch) {
  LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", mesh));
  const Json* extension = GltfDocument::extension(*json, kStreamExtension);
  if (extension == nullptr) return std::vector<std::byte>{};
  if (const std::string uri = string_member(*extension, "uri"); !uri.empty()) {
    LODESTONE_TRY(const std::filesystem::path path, uri_to_path(uri, kStreamExtension));
    return fetch(path);
  }
  LODESTONE_TRY(const std::size_t view_index, size_member(*extension, "bufferView", kStreamExtension));
  LODESTONE_TRY(const BufferView view, document.buffer_view(view_index));
  return std::vector<std::byte>(view.bytes.begin(), view.bytes.end());
}

}  // namespace lodestone::detail

#include "formats/loaded_bytes.h"

#include <set>
#include <system_error>

#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>

#include "base/json.h"
#include "formats/read_mesh_bytes.h"
#include "gltf/gltf_container.h"
#include "gltf/gltf_document.h"
#include "mesh/soup_file.h"

namespace lodestone {
namespace {

using namespace detail;

/// Lists the files that a glTF names beside it: buffers, images, streams.
std::set<std::filesystem::path> files_named_by(const Json& document) {
  std::set<std::filesystem::path> files;
  const auto add = [&](const Json& item, const char* what) {
    const std::string uri = string_member(item, "uri");
    if (uri.empty() || uri.starts_with("data:")) return;
    if (const auto path = uri_to_path(uri, what)) files.insert(path->lexically_normal());
  };
  const auto for_each = [&](const char* array, const auto& visit) {
    const Json* list = find_member(document, array);
    if (list == nullptr || !list->is_array()) return;
    for (const Json& item : *list) visit(item);
  };
  for (const char* array : {"buffers", "images"}) for_each(array, [&](const Json& item) { add(item, array); });
  for_each("meshes", [&](const Json& mesh) {
    if (const Json* stream = GltfDocument::extension(mesh, kStreamExtension)) add(*stream, kStreamExtension);
  });
  return files;
}

}  // namespace

std::uint64_t detail::bytes_beside(const Json& document, const std::filesystem::path& path) {
  std::uint64_t total = 0;
  for (const std::filesystem::path& file : files_named_by(document)) {
    std::error_code missing;
    const std::uintmax_t size = std::filesystem::file_size(path.parent_path() / file, missing);
    if (!missing) total += size;
  }
  return total;
}

Result<std::uint64_t> loaded_bytes(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  if (!is_gltf(bytes, extension_of(path))) return bytes.size();
  LODESTONE_TRY(const GltfContainer container, split_container(bytes));
  LODESTONE_TRY(const Json document, parse_json(container.json));
  return bytes.size() + bytes_beside(document, path);
}

}  // namespace lodestone

#include <lodestone/io/asset.h>

#include <lodestone/core/assemble.h>
#include <lodestone/io/file.h>

#include "gltf_flatten.h"
#include "gltf_primitive.h"
#include "gltf_scene.h"
#include "stream_extension.h"
#include "text.h"
#include "try.h"

namespace lodestone {
namespace {

using namespace detail;

Result<GltfDocument> read_document(std::span<const std::byte> bytes) {
  const auto fetch = [](const std::filesystem::path& path) -> Result<std::vector<std::byte>> {
    return fail(ErrorCode::Unsupported, text("'", path, "' is a file of its own; an asset is one file"));
  };
  LODESTONE_TRY(GltfDocument document, GltfDocument::parse(bytes, fetch));
  LODESTONE_CHECK(check_required_extensions(document));
  return document;
}

/// Fills in what the extras of a level's node say.
void read_numbers(const Json& node, Asset::Level& level) {
  const Json* extras = find_member(node, "extras");
  const Json* numbers = extras != nullptr ? find_member(*extras, "lodestone") : nullptr;
  if (numbers == nullptr) return;
  level.maximum_deviation = number_member(*numbers, "maximum_deviation", 0);
  level.mean_deviation = number_member(*numbers, "mean_deviation", 0);
  level.rms_deviation = number_member(*numbers, "rms_deviation", 0);
  level.curvature_error = number_member(*numbers, "curvature_error", 0);
}

/// Returns the entry of MSFT_screencoverage on the finest node; 0 where there is none.
double screen_coverage(const Json& finest, std::size_t level) {
  const Json* extras = find_member(finest, "extras");
  const Json* list = extras != nullptr ? find_member(*extras, "MSFT_screencoverage") : nullptr;
  if (list == nullptr || !list->is_array() || level >= list->size() || !(*list)[level].is_number()) return 0;
  return (*list)[level].get<double>();
}

Result<std::uint64_t> stored_bytes(const GltfDocument& document, std::size_t mesh) {
  LODESTONE_TRY(const auto views, geometry_views(document, mesh));
  std::uint64_t bytes = 0;
  for (const std::size_t view : views) {
    LODESTONE_TRY(const Json* const json, document.element("bufferViews", "buffer view", view));
    LODESTONE_TRY(const std::size_t size, size_member(*json, "byteLength", text("buffer view ", view)));
    bytes += size;
  }
  return bytes;
}

Result<Asset::Level> read_level(const GltfDocument& document, std::size_t index, std::span<const std::size_t> chain) {
  Asset::Level level;
  LODESTONE_TRY(const SoupFile file, flatten_scene(document, index));
  LODESTONE_TRY(AssembledMesh assembled, assemble(file.soup));
  level.mesh = std::move(assembled.mesh);

  LODESTONE_TRY(const auto instances, collect_instances(document, index));
  for (const MeshInstance& instance : instances) {
    LODESTONE_TRY(const std::uint64_t bytes, stored_bytes(document, instance.mesh));
    level.byte_length += bytes;
    level.draco |= uses_draco(document, instance.mesh);
  }
  std::size_t node = index < chain.size() ? chain[index] : kNoNode;
  if (node == kNoNode && !instances.empty()) node = instances[0].node;
  if (node == kNoNode) return level;
  LODESTONE_TRY(const Json* const json, document.element("nodes", "node", node));
  read_numbers(*json, level);
  if (!chain.empty()) {
    LODESTONE_TRY(const Json* const finest, document.element("nodes", "node", chain[0]));
    level.screen_coverage = screen_coverage(*finest, index);
  }
  return level;
}

/// Returns the first mesh's removal stream, empty where no mesh has one.
Result<std::vector<std::byte>> find_stream(const GltfDocument& document) {
  for (std::size_t i = 0; i < document.count("meshes"); ++i) {
    LODESTONE_TRY(const Json* const mesh, document.element("meshes", "mesh", i));
    const Json* extension = GltfDocument::extension(*mesh, kStreamExtension);
    if (extension == nullptr) continue;
    LODESTONE_TRY(const std::size_t view_index, size_member(*extension, "bufferView", kStreamExtension));
    LODESTONE_TRY(const BufferView view, document.buffer_view(view_index));
    return std::vector<std::byte>(view.bytes.begin(), view.bytes.end());
  }
  return std::vector<std::byte>{};
}

Error with_path(Error error, const std::filesystem::path& path) {
  error.message = text('\'', path, "': ", error.message);
  return error;
}

}  // namespace

Result<Asset> read_asset_bytes(std::span<const std::byte> bytes) {
  LODESTONE_TRY(const GltfDocument document, read_document(bytes));
  LODESTONE_TRY(const std::size_t count, level_count(document));
  LODESTONE_TRY(const auto chain, first_lod_chain(document));
  Asset asset;
  for (std::size_t i = 0; i < count; ++i) {
    LODESTONE_TRY(Asset::Level level, read_level(document, i, chain));
    asset.levels.push_back(std::move(level));
  }
  LODESTONE_TRY(asset.stream, find_stream(document));
  asset.total_bytes = bytes.size();
  return asset;
}

Result<Asset> read_asset(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  return read_asset_bytes(bytes).map_error([&](Error error) { return with_path(std::move(error), path); });
}

Result<std::vector<std::byte>> read_asset_stream(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  const auto stream = read_document(bytes).and_then(find_stream);
  if (!stream) return tl::unexpected<Error>(with_path(stream.error(), path));
  if (stream->empty()) return fail(ErrorCode::Unsupported, text('\'', path, "': holds no removal stream"));
  return *stream;
}

}  // namespace lodestone

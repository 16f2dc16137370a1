#include "input_files.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>

#include "error_size.h"
#include "messages.h"
#include "standard_streams.h"

namespace lodestone::tool {
namespace {

constexpr std::size_t kLookedAt = 1000;  // bytes, of which all but the last may be spaces

Error of_standard_input(Error error) {
  error.message = "standard input: " + error.message;
  return error;
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Whether bytes look like glTF: a .glb, or JSON.
bool may_be_gltf(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  return text.starts_with("glTF") || trimmed(text.substr(0, kLookedAt)).starts_with('{');
}

Result<std::vector<std::byte>> read_bytes(const std::filesystem::path& path) {
  return is_standard_stream(path) ? read_standard_input() : read_file(path);
}

/// Returns a file's first bytes; none of one that cannot be read.
std::vector<std::byte> read_start(const std::filesystem::path& path) {
  std::vector<std::byte> bytes(kLookedAt);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

/// Returns the bytes of a file, of a glTF with those of the files beside it.
std::uint64_t bytes_of(const std::filesystem::path& path, bool gltf) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  const std::uint64_t alone = error ? 0 : size;
  return gltf ? loaded_bytes(path).value_or(alone) : alone;
}

/// Opens a file whose bytes have been read.
Result<Asset> open_asset(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  return is_standard_stream(path) ? Asset::read_bytes(bytes) : Asset::read(path);
}

/// Nothing for a file without levels and streams.
Result<std::optional<DecodedAsset>> decode_asset(const Asset& asset) {
  DecodedAsset decoded;
  LODESTONE_TRY(decoded.streams, asset.streams());
  if (asset.level_count() < 2 && decoded.streams.empty()) return std::nullopt;
  LODESTONE_TRY(decoded.levels, asset.levels());
  decoded.total_bytes = asset.total_bytes();
  return decoded;
}

}  // namespace

Result<Scene> read_scene(const std::filesystem::path& path, const std::string& format) {
  if (!is_standard_stream(path)) return Scene::read(path);
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_standard_input());
  return Scene::read_bytes(bytes, format).map_error(of_standard_input);
}

Result<MeshFile> read_mesh_file(const std::filesystem::path& path, const std::string& format) {
  if (!is_standard_stream(path)) return read_mesh(path);
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_standard_input());
  return read_mesh_bytes(bytes, format).map_error(of_standard_input);
}

Result<AssetOrScene> read_asset_or_scene(const std::filesystem::path& path) {
  const bool is_stream = is_standard_stream(path);
  std::vector<std::byte> bytes;  // all of standard input, of a file what tells its kind
  if (is_stream) {
    LODESTONE_TRY(bytes, read_standard_input());
  } else {
    bytes = read_start(path);
  }
  AssetOrScene file;
  if (may_be_gltf(bytes)) {
    auto asset = open_asset(path, bytes).and_then(decode_asset);
    if (is_stream) asset = std::move(asset).map_error(of_standard_input);
    // A .glb from elsewhere may hold what only the general reader understands.
    if (!asset && asset.error().code != ErrorCode::Unsupported) return tl::unexpected(asset.error());
    if (asset) file.asset = std::move(*asset);
  }
  if (file.asset) return file;
  Result<Scene> scene = is_stream ? Scene::read_bytes(bytes, "") : Scene::read(path);
  if (!scene && scene.error().code == ErrorCode::Unsupported) {
    LODESTONE_TRY(MeshFile mesh, is_stream ? read_mesh_bytes(bytes, "") : read_mesh(path));
    scene = Scene::from_mesh(std::move(mesh), path.stem().string());
  }
  if (!scene) return tl::unexpected(scene.error());
  file.scene = std::move(*scene);
  file.bytes = is_stream ? bytes.size() : bytes_of(path, may_be_gltf(bytes));
  return file;
}

Result<Scene> read_levels(const std::filesystem::path& path, std::size_t level) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_bytes(path));
  if (!may_be_gltf(bytes))
    return tl::unexpected(not_streamed(path, ErrorCode::Unsupported, "it is neither .glb nor .gltf"));
  Result<Scene> scene = open_asset(path, bytes).and_then([&](const Asset& asset) { return asset.scene(level); });
  if (is_standard_stream(path)) scene = std::move(scene).map_error(of_standard_input);
  const bool is_text = as_text(bytes).front() != 'g';
  if (scene ||
      (scene.error().code != ErrorCode::Unsupported && !(is_text && scene.error().code == ErrorCode::Malformed)))
    return scene;
  std::string why = scene.error().message;
  if (const std::string prefix = quoted(path) + ": "; why.starts_with(prefix)) why.erase(0, prefix.size());
  return tl::unexpected(not_streamed(path, scene.error().code, why));
}

Result<std::optional<StreamFile>> read_stream_file(const std::filesystem::path& path) {
  if (is_standard_stream(path) || !is_stream(read_start(path))) return std::nullopt;
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  StreamReader reader;
  const Result<void> read = reader.append(bytes).and_then([&] { return reader.finish(); });
  if (!read) return fail(read.error().code, quoted(path) + ": " + read.error().message, read.error().byte_offset);
  std::vector<ReaderChunk> chunks(reader.chunks().begin(), reader.chunks().end());
  return StreamFile{std::move(reader).take_mesh(), std::move(chunks), bytes.size()};
}

Result<std::vector<Asset::Stream>> read_streams(const std::filesystem::path& path) {
  LODESTONE_TRY(std::vector<std::byte> bytes, read_bytes(path));
  if (is_stream(bytes)) return std::vector<Asset::Stream>{{"", std::move(bytes)}};
  if (!may_be_gltf(bytes))
    return tl::unexpected(not_streamed(path, ErrorCode::Unsupported, "it is neither .glb nor .gltf, nor a stream"));
  auto streams = open_asset(path, bytes).and_then([](const Asset& asset) { return asset.streams(); });
  if (is_standard_stream(path)) streams = std::move(streams).map_error(of_standard_input);
  if (streams && streams->empty())
    return tl::unexpected(not_streamed(path, ErrorCode::Unsupported, "none of its meshes has one"));
  return streams;
}

Error not_streamed(const std::filesystem::path& path, ErrorCode code, const std::string& why) {
  return {code, quoted(path) + ": not a file with a removal stream, as lodestone build makes one: " + why,
          std::nullopt};
}

}  // namespace lodestone::tool

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/stream_reader.h>

namespace lodestone::tool {

// Readers of files, and of the standard input where the path means that. Errors: as those of the library's readers.

/// Reads a scene; `format` says what the standard input is, as an extension without its dot; empty: as its content
/// does.
Result<Scene> read_scene(const std::filesystem::path& path, const std::string& format);

/// Reads a mesh; `format` as above.
Result<MeshFile> read_mesh_file(const std::filesystem::path& path, const std::string& format = "");

/// A glTF with levels of detail or removal streams, all decoded.
struct DecodedAsset {
  std::vector<Asset::Level> levels;
  std::vector<Asset::Stream> streams;
  std::uint64_t total_bytes = 0;
};

/// A stream in a file of its own.
struct StreamFile {
  ProgressiveMesh mesh;
  std::vector<ReaderChunk> chunks;
  std::uint64_t bytes = 0;  ///< of the file
};

/// What a file turned out to be.
struct AssetOrScene {
  std::optional<DecodedAsset> asset;
  std::optional<Scene> scene;  ///< what build would take any other file for
  std::uint64_t bytes = 0;     ///< with what lies beside it
};

/// Reads whatever a file is; of those that build refuses, such as with levels of other programs, the finest level.
Result<AssetOrScene> read_asset_or_scene(const std::filesystem::path& path);

/// Reads a level of a multi-LOD file and the streams. Errors: as not_streamed says it for what was not made for this.
Result<Scene> read_levels(const std::filesystem::path& path, std::size_t level);

/// Reads a file that is a stream alone; nothing of one that is something else, or the standard input. Errors: as those
/// of StreamReader; a file that ends early is what has come so far.
Result<std::optional<StreamFile>> read_stream_file(const std::filesystem::path& path);

/// Reads the streams of a file, as they are: one that is a stream alone, whose mesh has no name, or those of a glTF.
/// Errors: as not_streamed says it for a file without any.
Result<std::vector<Asset::Stream>> read_streams(const std::filesystem::path& path);

/// Returns the error of a file that has no stream where one is needed, whatever it is.
Error not_streamed(const std::filesystem::path& path, ErrorCode code, const std::string& why);

}  // namespace lodestone::tool

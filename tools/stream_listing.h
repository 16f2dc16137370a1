#pragma once

#include <optional>
#include <span>
#include <string>

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_format.h>

#include "json_text.h"

namespace lodestone::tool {

/// Of the JSON that `inspect` prints: raised by one whenever a member changes its meaning or goes away.
inline constexpr int kInspectSchemaVersion = 1;

std::string text_of(std::uint64_t number);

/// What is told of a stream.
struct ListedStream {
  std::string mesh;  ///< its name
  StreamDirectory directory;
  std::optional<CompactParts> parts;  ///< of a compact one, where they are asked for
};

/// Returns the directory of a stream of any version. Of a compact one it says what there is of it: its chunks are not
/// compressed by themselves, and have no curvature errors.
Result<StreamDirectory> directory_of(std::span<const std::byte> stream);
/// Decodes a stream for what its parts take. Errors: those of read_stream_directory and measure_compact.
Result<ListedStream> list_stream(const Asset::Stream& stream);

/// A stream with its chunks.
Json stream_json(const StreamDirectory& directory);
void print_stream(const ListedStream& stream);

/// The streams of a file with what their parts and rounds take, and parts of all together.
Json parts_json(const std::string& path, std::span<const ListedStream> streams);
void print_parts(const std::string& path, std::span<const ListedStream> streams);

}  // namespace lodestone::tool

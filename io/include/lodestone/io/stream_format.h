#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/progress.h>
#include <lodestone/core/result.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// Settings of the removal stream's container; docs/stream-format.md is the normative description.
struct StreamOptions {
  int zstd_level = 9;                    ///< 1 to 19
  std::size_t records_per_chunk = 4096;  ///< a chunk ends at the round boundary after about this many
  Progress progress;
};

/// One entry of a stream's directory.
struct StreamChunk {
  std::uint64_t byte_offset = 0;    ///< from the start of the stream
  std::uint64_t byte_length = 0;    ///< as stored
  std::uint64_t decoded_bytes = 0;  ///< after decompression
  std::uint64_t checksum = 0;       ///< XXH64 of the stored bytes
  Index record_begin = 0;           ///< first record; chunk 0 is the base mesh and holds none
  Index record_count = 0;
  std::uint64_t face_count = 0;    ///< of the level after the chunk
  std::uint64_t vertex_count = 0;  ///< of the level after the chunk
  float deviation = 0;             ///< bound of the level after the chunk, mesh units
  float curvature_error = 0;       ///< of the level after the chunk
};

/// The header and directory of a stream, readable without its chunks.
struct StreamDirectory {
  std::uint16_t version_major = 0;
  std::uint16_t version_minor = 0;
  std::uint64_t total_bytes = 0;
  std::vector<StreamChunk> chunks;  ///< chunk 0: the base mesh; the others in refinement order
};

/// Encodes a progressive mesh, losslessly. Deterministic for one zstd version. Errors: InvalidArgument, LimitExceeded,
/// Cancelled.
Result<std::vector<std::byte>> encode_stream(const ProgressiveMesh& mesh, const StreamOptions& options = {});

/// Reads header and directory; the chunks need not be there yet.
Result<StreamDirectory> read_stream_directory(std::span<const std::byte> bytes);

/// Decodes a whole stream, or its first chunks where `bytes` ends early on a chunk boundary. The result is valid
/// whatever the bytes. Errors: Malformed, LimitExceeded, Unsupported (a newer major version), with offsets.
Result<ProgressiveMesh> decode_stream(std::span<const std::byte> bytes);

}  // namespace lodestone

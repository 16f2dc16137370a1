#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <lodestone/core/result.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// Bytes of a stream: [begin, end).
struct ByteRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;

  bool empty() const { return begin == end; }
};

/// A chunk of a stream of any version, and the level that it and those before it lead to.
struct ReaderChunk {
  ByteRange bytes;                 ///< from the start of the stream
  Index position = 0;              ///< of the level; chunk 0 holds the base mesh, too
  std::uint64_t vertex_count = 0;  ///< of the level
  std::uint64_t face_count = 0;    ///< of the level
  float deviation = 0;             ///< bound of the level, mesh units
};

struct StreamReaderOptions {
  /// What the mesh may take, in bytes; a chunk that leads beyond is an error. Checked after each round of a compact
  /// stream, in which every face belongs to one record at most, and after each chunk of others.
  std::uint64_t most_bytes = std::uint64_t{1} << 31U;
};

/// Reads a stream of any version (docs/stream-format.md, docs/compact-stream.md) while its bytes arrive, in pieces of
/// any size: whatever the pieces, the mesh is the same.
///
/// The mesh grows by whole chunks, each decoded where its last byte arrives. It is valid at any time, whatever the
/// bytes, and its last position is the level that the chunks so far lead to. What it has stays as it is, so that a
/// cursor over it goes on; spans of its arrays do not stay.
///
/// Allocates for what has arrived, never for what a number says: the bytes of one chunk; the mesh, about 92 bytes for
/// each vertex without attributes; and what decoding needs, up to 540 for each, which is given back at the end. One
/// thread at a time, that of cursors over the mesh included.
class StreamReader {
 public:
  explicit StreamReader(const StreamReaderOptions& options = {});
  StreamReader(StreamReader&&) noexcept;
  StreamReader& operator=(StreamReader&&) noexcept;
  ~StreamReader();

  /// Takes the next bytes. Errors: Malformed, LimitExceeded, Unsupported, with offsets; the mesh then stays what it is,
  /// and all that is said to come gives the same error again.
  Result<void> append(std::span<const std::byte> piece);
  /// Takes bytes from an offset of the stream on, and skips those that have been taken before, whatever they are.
  /// Errors: InvalidArgument where bytes are missing before them, after which the reader goes on; those of append.
  Result<void> append_at(std::uint64_t offset, std::span<const std::byte> piece);
  /// Says that no more bytes come. Errors: Malformed inside the header or a chunk; a stream cut off behind one is good,
  /// but not done().
  Result<void> finish();

  /// How many bytes have been taken.
  std::uint64_t byte_count() const;
  /// The bytes that are due next: those missing of the header's beginning, of the header, or of a chunk. Empty at the
  /// end, and after an error.
  ByteRange due() const;
  /// All chunks, from the first; none before the header is complete.
  std::span<const ReaderChunk> chunks() const;
  /// How many of them have been decoded.
  std::size_t chunk_count() const;
  /// Whether the whole stream has been decoded.
  bool done() const;
  /// What append has failed with.
  const std::optional<Error>& error() const;

  /// The mesh so far, at the same address as long as the reader lives, wherever that is moved; without anything before
  /// the first chunk.
  const ProgressiveMesh& mesh() const;
  /// Gives the mesh away; the reader is of no use then.
  ProgressiveMesh take_mesh() &&;

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// Returns whether bytes begin as a stream of any version does.
bool is_stream(std::span<const std::byte> bytes);

/// Returns the major version that a stream says it has, 3 for a compact one; 0 for bytes that are none.
std::uint16_t stream_version(std::span<const std::byte> bytes);

/// Decodes a stream of any version, whole or cut off behind a chunk. Errors: those of StreamReader.
Result<ProgressiveMesh> read_stream(std::span<const std::byte> bytes);

}  // namespace lodestone

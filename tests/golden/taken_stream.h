#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>

#include "stream/stream_columns.h"

namespace lodestone::test {

using StreamBytes = std::vector<std::byte>;

/// A stream taken apart into its header and chunks, to change something and put it together again. Chunks whose columns
/// are changed have stored blocks only, so that the bytes do not depend on zstd.
class TakenStream {
 public:
  /// Pre: a valid stream of version 2.0.
  explicit TakenStream(std::span<const std::byte> bytes);

  std::size_t chunk_count() const { return chunks_.size(); }
  StreamBytes& header() { return header_; }
  StreamBytes& chunk(std::size_t i) { return chunks_[i]; }

  /// Returns a chunk's columns, as section 5 or 6 of docs/stream-format.md lists them.
  std::vector<detail::Column> columns(std::size_t chunk) const;
  /// Writes a chunk anew, and how many bytes it decodes to.
  void set_columns(std::size_t chunk, std::span<const detail::Column> columns);

  /// Where a field of the directory's entry for a chunk lies in the header.
  static std::size_t entry(std::size_t chunk, std::size_t field) { return 64 + 64 * chunk + field; }
  template <class T>
  void put(std::size_t at, T value) {
    std::memcpy(header_.data() + at, &value, sizeof value);
  }
  template <class T>
  T get(std::size_t at) const {
    T value;
    std::memcpy(&value, header_.data() + at, sizeof value);
    return value;
  }

  /// Writes the chunks' offsets, lengths and checksums, and the stream's length. Pre: the header has its usual sizes.
  TakenStream& lay_out();
  /// Writes the header's checksum.
  TakenStream& seal();
  StreamBytes joined() const;
  /// All three.
  StreamBytes sealed() { return lay_out().seal().joined(); }

 private:
  std::vector<Attribute> attributes_;  ///< they tell how many columns a chunk has
  StreamBytes header_;
  std::vector<StreamBytes> chunks_;
};

// What chunks are made of.

void append_varint(StreamBytes& out, std::uint64_t value);
StreamBytes stored_block(std::span<const std::byte> bytes);
/// `frame`: what the block holds; `decoded`: how many bytes it says that is.
StreamBytes zstd_block(std::span<const std::byte> frame, std::size_t decoded);
/// A zstd frame of fewer than 256 bytes, uncompressed, so that every zstd gives the same. `stated`: its content's size.
StreamBytes zstd_frame(std::span<const std::byte> bytes, std::size_t stated);
/// The bytes of each block of a column.
std::vector<StreamBytes> planes(const detail::Column& column);

/// A block of a valid chunk.
struct Block {
  int mode = 0;  ///< 0 stored, 1 run, 2 zstd
  std::size_t begin = 0, end = 0;
};
std::vector<Block> blocks_of(std::span<const std::byte> chunk, std::uint64_t decoded_bytes);

}  // namespace lodestone::test

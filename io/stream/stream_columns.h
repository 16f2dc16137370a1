#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::detail {

/// How a column's values become bytes.
enum class Coding : std::uint8_t {
  Varint = 0,   ///< base 128, low digits first: small numbers
  Planes1 = 1,  ///< one byte each
  Planes2 = 2,  ///< all low bytes, then all high bytes
  Planes4 = 4,  ///< the same with four planes, low bytes first
};

/// Values of one kind that lie next to each other in a chunk, so that they compress together.
struct Column {
  Coding coding = Coding::Varint;
  std::vector<std::uint32_t> values;
};

/// A coded chunk before its place in a stream is known.
struct CodedChunk {
  std::vector<std::byte> bytes;
  std::uint64_t decoded_bytes = 0;
};

/// Codes columns one after the other, each byte plane stored, as a run or with zstd, whichever is smallest.
CodedChunk encode_columns(std::span<const Column> columns, int zstd_level);

/// Takes columns off the front of a coded chunk. Errors: Malformed.
class ColumnReader {
 public:
  /// The columns have to amount to `decoded_bytes`; what is allocated is bounded by it.
  ColumnReader(std::span<const std::byte> bytes, std::uint64_t decoded_bytes) : bytes_(bytes), budget_(decoded_bytes) {}

  /// Reads the next column, whose coding is given, into `column.values`.
  Result<void> read(Column& column);
  /// Checks that nothing but padding is left.
  Result<void> finish() const;

 private:
  tl::unexpected<Error> broken(const std::string& message) const;
  Result<std::uint64_t> varint();
  Result<std::span<const std::byte>> take(std::uint64_t size);
  Result<std::vector<std::byte>> block();
  Result<std::vector<std::byte>> zstd_block(std::size_t decoded);

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint64_t budget_;
};

/// Maps numbers of either sign, given modulo 2^32, so that those near 0 become small.
constexpr std::uint32_t zigzag(std::uint32_t value) { return (value << 1) ^ (value >> 31 ? ~0u : 0u); }
constexpr std::uint32_t unzigzag(std::uint32_t value) { return (value >> 1) ^ (value & 1 ? ~0u : 0u); }

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::detail {

/// How a column's values become bytes.
enum class Coding : std::uint8_t {
  Varint = 0,  ///< base 128, low digits first: small numbers
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

/// Decodes columns whose codings are given, from all of `bytes`. Allocates at most in proportion to `decoded_bytes`,
/// which the columns have to amount to exactly. Errors: Malformed.
Result<void> decode_columns(std::span<const std::byte> bytes, std::uint64_t decoded_bytes, std::span<Column> columns);

/// Maps numbers of either sign, given modulo 2^32, so that those near 0 become small.
constexpr std::uint32_t zigzag(std::uint32_t value) { return (value << 1) ^ (value >> 31 ? ~0u : 0u); }
constexpr std::uint32_t unzigzag(std::uint32_t value) { return (value >> 1) ^ (value & 1 ? ~0u : 0u); }

}  // namespace lodestone::detail

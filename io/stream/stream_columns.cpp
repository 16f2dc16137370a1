#include "stream/stream_columns.h"

#include <algorithm>
#include <string>

#include <zstd.h>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "stream/stream_layout.h"

// Columns before an entropy coder, as column stores keep them (D. J. Abadi, S. R. Madden, M. Ferreira: Integrating
// compression and execution in column-oriented database systems, SIGMOD 2006): values of one kind lie together, split
// into byte planes, and each plane is a run, a zstd frame or stored, whichever is smallest.

namespace lodestone::detail {
namespace {

enum class BlockMode : std::uint8_t { Stored = 0, Run = 1, Zstd = 2 };

constexpr std::size_t kMaxVarintBytes = 10;

std::size_t plane_count(Coding coding) { return std::max<std::size_t>(1, static_cast<std::size_t>(coding)); }

/// Lays one plane of a column out as bytes; the only plane of a Varint column is its text of digits.
std::vector<std::byte> plane_bytes(const Column& column, std::size_t plane) {
  std::vector<std::byte> out;
  out.reserve(column.values.size());
  for (const std::uint32_t value : column.values) {
    if (column.coding == Coding::Varint)
      append_varint(out, value);
    else
      out.push_back(static_cast<std::byte>(value >> (8 * plane)));
  }
  return out;
}

void append_block(std::vector<std::byte>& out, BlockMode mode, std::size_t decoded, std::span<const std::byte> stored) {
  append(out, mode);
  append_varint(out, decoded);
  if (mode == BlockMode::Zstd) append_varint(out, stored.size());
  append_bytes(out, stored);
}

void append_smallest_block(std::vector<std::byte>& out, std::span<const std::byte> bytes, int zstd_level,
                           std::vector<std::byte>& scratch) {
  if (!bytes.empty() && std::all_of(bytes.begin(), bytes.end(), [&](std::byte b) { return b == bytes[0]; }))
    return append_block(out, BlockMode::Run, bytes.size(), bytes.first(1));
  scratch.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(scratch.data(), scratch.size(), bytes.data(), bytes.size(), zstd_level);
  if (!ZSTD_isError(size) && size + 2 < bytes.size())
    append_block(out, BlockMode::Zstd, bytes.size(), std::span(scratch).first(size));
  else
    append_block(out, BlockMode::Stored, bytes.size(), bytes);
}

Result<void> parse_varints(std::span<const std::byte> bytes, std::vector<std::uint32_t>& values) {
  std::uint64_t value = 0;
  int shift = 0;
  for (const std::byte b : bytes) {
    value |= (static_cast<std::uint64_t>(b) & 0x7f) << shift;
    shift += 7;
    if ((b & std::byte{0x80}) != std::byte{0}) {
      if (shift >= 35) return fail(ErrorCode::Malformed, "broken number in a column");
      continue;
    }
    if (value > 0xffffffff) return fail(ErrorCode::Malformed, "broken number in a column");
    values.push_back(static_cast<std::uint32_t>(value));
    value = 0;
    shift = 0;
  }
  if (shift != 0) return fail(ErrorCode::Malformed, "broken number in a column");
  return {};
}

}  // namespace

CodedChunk encode_columns(std::span<const Column> columns, int zstd_level) {
  CodedChunk chunk;
  std::vector<std::byte> scratch;
  for (const Column& column : columns)
    for (std::size_t plane = 0; plane < plane_count(column.coding); ++plane) {
      const std::vector<std::byte> bytes = plane_bytes(column, plane);
      append_smallest_block(chunk.bytes, bytes, zstd_level, scratch);
      chunk.decoded_bytes += bytes.size();
    }
  // Padding keeps the ratio a decoder may rely on, where data are as regular as a flat grid.
  chunk.bytes.resize(std::max<std::size_t>(chunk.bytes.size(), chunk.decoded_bytes / kMaxExpansion));
  return chunk;
}

tl::unexpected<Error> ColumnReader::broken(const std::string& message) const {
  return fail(ErrorCode::Malformed, message, at_);
}

Result<std::uint64_t> ColumnReader::varint() {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < kMaxVarintBytes && at_ < bytes_.size(); ++i) {
    const auto digit = static_cast<std::uint8_t>(bytes_[at_++]);
    value |= std::uint64_t{digit & 0x7fu} << (7 * i);
    if (digit < 0x80) return value;
  }
  return broken("broken number");
}

Result<std::span<const std::byte>> ColumnReader::take(std::uint64_t size) {
  if (size > bytes_.size() - at_)
    return broken(text("block of ", size, " bytes where ", bytes_.size() - at_, " are left"));
  const auto taken = bytes_.subspan(at_, static_cast<std::size_t>(size));
  at_ += taken.size();
  return taken;
}

Result<std::vector<std::byte>> ColumnReader::block() {
  if (at_ == bytes_.size()) return broken("ends before its last block");
  const auto mode = static_cast<BlockMode>(bytes_[at_++]);
  LODESTONE_TRY(const std::uint64_t decoded, varint());
  if (decoded > budget_) return broken(text("block of ", decoded, " bytes where ", budget_, " are left to decode"));
  budget_ -= decoded;
  if (mode == BlockMode::Zstd) return zstd_block(static_cast<std::size_t>(decoded));
  if (mode != BlockMode::Stored && mode != BlockMode::Run) return broken("unknown kind of block");
  LODESTONE_TRY(const auto bytes, take(mode == BlockMode::Run ? 1 : decoded));
  if (mode == BlockMode::Run) return std::vector<std::byte>(static_cast<std::size_t>(decoded), bytes[0]);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<std::vector<std::byte>> ColumnReader::zstd_block(std::size_t decoded) {
  LODESTONE_TRY(const std::uint64_t size, varint());
  LODESTONE_TRY(const auto bytes, take(size));
  if (ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != decoded) return broken("zstd frame of another size");
  std::vector<std::byte> out(decoded);
  const std::size_t result = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(result)) return broken(text("zstd: ", ZSTD_getErrorName(result)));
  if (ZSTD_findFrameCompressedSize(bytes.data(), bytes.size()) != bytes.size())
    return broken("more than one zstd frame in a block");
  return out;
}

Result<void> ColumnReader::read(Column& column) {
  LODESTONE_TRY(const std::vector<std::byte> first, block());
  column.values.clear();
  if (column.coding == Coding::Varint) return parse_varints(first, column.values);
  column.values.reserve(first.size());
  for (const std::byte b : first) column.values.push_back(static_cast<std::uint32_t>(b));
  for (std::size_t plane = 1; plane < plane_count(column.coding); ++plane) {
    LODESTONE_TRY(const std::vector<std::byte> bytes, block());
    if (bytes.size() != first.size()) return broken("planes of different sizes");
    for (std::size_t i = 0; i < bytes.size(); ++i)
      column.values[i] |= static_cast<std::uint32_t>(bytes[i]) << (8 * plane);
  }
  return {};
}

Result<void> ColumnReader::finish() const {
  if (budget_ != 0) return broken(text(budget_, " bytes are missing"));
  const auto rest = bytes_.subspan(at_);
  if (std::any_of(rest.begin(), rest.end(), [](std::byte b) { return b != std::byte{0}; }))
    return broken("bytes follow its last block");
  return {};
}

}  // namespace lodestone::detail

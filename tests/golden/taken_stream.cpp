#include "golden/taken_stream.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include <lodestone/io/stream_format.h>

#include "stream/stream_layout.h"
#include "stream/stream_records.h"

namespace lodestone::test {
namespace {

using detail::checksum64;
using detail::Coding;
using detail::Column;
using detail::ColumnReader;

void append(StreamBytes& out, std::span<const std::byte> bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

template <class T>
T good(Result<T> result) {
  if (result) return std::move(*result);
  std::cerr << "a golden stream is broken: " << result.error().message << std::endl;
  std::abort();
}

std::uint64_t take_varint(std::span<const std::byte> bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const auto digit = static_cast<std::uint8_t>(bytes[at++]);
    value |= std::uint64_t{digit & 0x7fu} << shift;
    if (digit < 0x80) return value;
  }
}

}  // namespace

TakenStream::TakenStream(std::span<const std::byte> bytes) : attributes_(good(decode_stream(bytes)).attributes) {
  const StreamDirectory directory = good(read_stream_directory(bytes));
  const auto from = [&](std::uint64_t at, std::uint64_t size) {
    const auto part = bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
    return StreamBytes(part.begin(), part.end());
  };
  header_ = from(0, directory.chunks[0].byte_offset);
  for (const StreamChunk& chunk : directory.chunks) chunks_.push_back(from(chunk.byte_offset, chunk.byte_length));
}

std::vector<Column> TakenStream::columns(std::size_t chunk) const {
  std::vector<Column> columns = chunk == 0 ? detail::base_columns(attributes_) : detail::record_columns(attributes_);
  ColumnReader reader(chunks_[chunk], get<std::uint64_t>(entry(chunk, 16)));
  for (Column& column : columns)
    if (!reader.read(column)) std::abort();
  return columns;
}

void TakenStream::set_columns(std::size_t chunk, std::span<const Column> columns) {
  StreamBytes& out = chunks_[chunk];
  out.clear();
  std::uint64_t decoded = 0;
  for (const Column& column : columns)
    for (const StreamBytes& plane : planes(column)) {
      append(out, stored_block(plane));
      decoded += plane.size();
    }
  put(entry(chunk, 16), decoded);
}

TakenStream& TakenStream::lay_out() {
  std::uint64_t offset = header_.size();
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    put(entry(i, 0), offset);
    put(entry(i, 8), std::uint64_t{chunks_[i].size()});
    put(entry(i, 24), checksum64(chunks_[i]));
    offset += chunks_[i].size();
  }
  put(16, offset);
  return *this;
}

TakenStream& TakenStream::seal() {
  const std::size_t end = header_.size() - 8;
  put(end, checksum64(std::span(header_).first(end)));
  return *this;
}

StreamBytes TakenStream::joined() const {
  StreamBytes all = header_;
  for (const StreamBytes& chunk : chunks_) append(all, chunk);
  return all;
}

void append_varint(StreamBytes& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::byte>((value & 0x7f) | 0x80));
  out.push_back(static_cast<std::byte>(value));
}

StreamBytes stored_block(std::span<const std::byte> bytes) {
  StreamBytes out{std::byte{0}};
  append_varint(out, bytes.size());
  append(out, bytes);
  return out;
}

StreamBytes zstd_block(std::span<const std::byte> frame, std::size_t decoded) {
  StreamBytes out{std::byte{2}};
  append_varint(out, decoded);
  append_varint(out, frame.size());
  append(out, frame);
  return out;
}

// RFC 8878: magic number, a descriptor (one segment, the size in one byte), the size, one raw block, the last.
StreamBytes zstd_frame(std::span<const std::byte> bytes, std::size_t stated) {
  StreamBytes out;
  const std::size_t block = bytes.size() << 3 | 1;
  for (const std::size_t byte : {std::size_t{0x28}, std::size_t{0xb5}, std::size_t{0x2f}, std::size_t{0xfd},
                                 std::size_t{0x20}, stated, block & 0xff, block >> 8 & 0xff, block >> 16})
    out.push_back(static_cast<std::byte>(byte));
  append(out, bytes);
  return out;
}

std::vector<StreamBytes> planes(const Column& column) {
  std::vector<StreamBytes> all(std::max<std::size_t>(1, static_cast<std::size_t>(column.coding)));
  for (const std::uint32_t value : column.values) {
    if (column.coding == Coding::Varint) {
      append_varint(all[0], value);
      continue;
    }
    for (std::size_t plane = 0; plane < all.size(); ++plane)
      all[plane].push_back(static_cast<std::byte>(value >> (8 * plane)));
  }
  return all;
}

std::vector<Block> blocks_of(std::span<const std::byte> chunk, std::uint64_t decoded_bytes) {
  std::vector<Block> blocks;
  std::size_t at = 0;
  // Blocks without bytes at the end are left out: they look like padding.
  for (std::uint64_t done = 0; done < decoded_bytes;) {
    Block block{static_cast<int>(chunk[at]), at, 0};
    ++at;
    const std::uint64_t decoded = take_varint(chunk, at);
    const std::uint64_t stored = block.mode == 0 ? decoded : block.mode == 1 ? 1 : take_varint(chunk, at);
    block.end = at += static_cast<std::size_t>(stored);
    done += decoded;
    blocks.push_back(block);
  }
  return blocks;
}

}  // namespace lodestone::test

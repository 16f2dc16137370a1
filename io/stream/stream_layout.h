#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/stream_format.h>

namespace lodestone::detail {

// The fixed parts of a removal stream; docs/stream-format.md is the description that counts.

inline constexpr std::array<unsigned char, 8> kStreamMagic = {0x89, 'L', 'D', 'S', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint16_t kStreamMajor = 2;
inline constexpr std::uint16_t kStreamMinor = 0;
inline constexpr std::uint16_t kColumnEncoding = 1;  ///< how the chunks are coded: the only way so far

inline constexpr std::size_t kFixedHeaderBytes = 64;
inline constexpr std::size_t kDirectoryEntryBytes = 64;
inline constexpr std::size_t kHeaderChecksumBytes = 8;

/// A chunk decodes to at most this many times its stored bytes; the encoder pads those that would decode to more.
inline constexpr std::uint64_t kMaxExpansion = 256;
inline constexpr std::uint32_t kMaxGroups = 65536;
inline constexpr std::uint32_t kMaxAttributes = 64;
inline constexpr std::uint32_t kMaxNameBytes = 255;
inline constexpr std::uint32_t kMaxPolygonSize = 256;
inline constexpr std::uint32_t kMaxWedgesPerRecord = 65536;

/// The header's fixed part, beside what StreamDirectory shows.
struct StreamHeader {
  std::uint32_t header_bytes = 0;  ///< up to the first chunk
  std::uint32_t vertex_count = 0;
  std::uint32_t wedge_count = 0;
  std::uint32_t record_count = 0;
  std::uint32_t round_count = 0;
  std::uint32_t base_vertex_count = 0;
  std::uint32_t base_wedge_count = 0;
  std::uint32_t group_count = 0;
  std::uint32_t attribute_count = 0;
};

struct StreamStart {
  StreamHeader header;
  StreamDirectory directory;
  std::vector<std::uint32_t> wedge_counts;  ///< per chunk: of the level after it
};

/// Writes header, directory and their checksum.
std::vector<std::byte> write_stream_start(const StreamStart& start);

/// Reads and checks them: sizes, offsets and counts agree with each other, but the chunks need not be there.
Result<StreamStart> read_stream_start(std::span<const std::byte> bytes);

/// XXH64 with seed 0.
std::uint64_t checksum64(std::span<const std::byte> bytes);

}  // namespace lodestone::detail

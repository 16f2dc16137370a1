#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/compact_stream.h>

#include "codec/bit_coder.h"
#include "codec/number_coder.h"

namespace lodestone::detail {

// The fixed parts of a compact stream; docs/compact-stream.md is the description that counts.

inline constexpr std::uint16_t kCompactMajor = 3;
inline constexpr std::uint16_t kCompactMinor = 0;
inline constexpr int kLeastGridBits = 8;
inline constexpr int kMostGridBits = 16;
inline constexpr std::uint64_t kMostRecordsPerByte = 8;  ///< of a chunk; the encoder pads it
inline constexpr std::uint64_t kMostBasePerByte = 8;     ///< points and faces of the base mesh; the same
inline constexpr std::uint64_t kMostFacesWalked = 256;   ///< over all rounds, for each face of the full mesh

/// Returns the low half of XXH64.
std::uint32_t checksum32(std::span<const std::byte> bytes);

/// Errors on a logarithmic scale: code 0 is 0, code 255 the largest, eight codes a factor of two.
class ErrorScale {
 public:
  explicit ErrorScale(float largest = 0) : largest_(largest) {}
  float largest() const { return largest_; }
  float value(int code) const;
  /// Returns the least code whose value is not below `error`; 255 at most.
  int code(float error) const;

 private:
  float largest_;
};

struct CompactChunkEntry {
  std::uint64_t byte_length = 0;
  std::uint32_t round_count = 0;
  std::uint32_t record_count = 0;
  std::uint32_t open_count = 0;     ///< records that add one face; the others add two
  std::uint8_t deviation_code = 0;  ///< of the level after the chunk
  std::uint32_t checksum = 0;       ///< see checksum32

  std::uint64_t added_faces() const { return 2 * std::uint64_t{record_count} - open_count; }
};

struct CompactHeader {
  std::uint32_t header_bytes = 0;  ///< up to the first chunk
  int grid_bits = 0;
  CompactGrid grid;
  Index material = 0;
  Index base_point_count = 0;
  Index base_vertex_count = 0;  ///< fewer than points where the mesh has several sheets
  Index base_face_count = 0;
  ErrorScale deviation;
  ErrorScale curvature;
  std::vector<CompactChunkEntry> chunks;

  std::uint64_t face_count() const;
};

/// Returns where the chunks lie, and what they lead to.
std::vector<CompactChunk> compact_chunks(const CompactHeader& header);

/// Writes a header and its checksum.
std::vector<std::byte> write_compact_header(const CompactHeader& header);
/// Reads and checks a header: counts are within the limits that the chunks' lengths set.
Result<CompactHeader> read_compact_header(std::span<const std::byte> bytes);

/// Codes the errors of a level, which never rise.
class ErrorCoder {
 public:
  /// Codes a level's codes; a reader's are set. False where what is read rises.
  bool code(BitCoder& coder, int& deviation, int& curvature);

 private:
  static bool code(BitCoder& coder, NumberCoder& numbers, int& last, int& error);
  NumberCoder deviations_, curvatures_;
  int deviation_ = 255, curvature_ = 255;
};

}  // namespace lodestone::detail

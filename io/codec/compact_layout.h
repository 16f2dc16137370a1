#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/compact_stream.h>

#include "codec/attribute_spec.h"
#include "codec/bit_coder.h"
#include "codec/number_coder.h"

namespace lodestone::detail {

// The fixed parts of a compact stream; docs/compact-stream.md is the description that counts.

inline constexpr std::uint16_t kSmallMinor = 0;  ///< the minor version of streams of CompactCoding::Small
inline constexpr std::uint16_t kFastMinor = 1;   ///< the same of CompactCoding::Fast
inline constexpr int kLeastStepBits = 4;         ///< of coordinates in steps of a stage
inline constexpr int kLeastAttributeBits = 2;
inline constexpr int kMostAttributeBits = 24;
inline constexpr std::uint64_t kMostRecordsPerByte = 8;    ///< of a chunk; the encoder pads it
inline constexpr std::uint64_t kMostBasePerByte = 8;       ///< vertices, wedges and faces of the base mesh; the same
inline constexpr std::uint64_t kMostWedgesPerByte = 8;     ///< that a chunk adds; the same
inline constexpr std::uint64_t kMostNumbersPerByte = 256;  ///< of attributes that a chunk adds; the same
inline constexpr std::uint64_t kMostMovesEach = 4;         ///< up to the end of a chunk, by vertex of the level then
inline constexpr std::uint64_t kMostWalked = 256;          ///< by rounds up to the end of a chunk, see LevelCoder::size

inline constexpr std::uint64_t kEndOfCounts = std::uint64_t{1} << 30U;  ///< faces, wedges and vertices are fewer
inline constexpr int kMostComponents = 16;                              ///< of an attribute
inline constexpr Index kMostWedgesEach = 65536;  ///< of a record's vertex: sectors name them in 16 bits

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
  std::uint32_t face_count = 0;     ///< faces that its records add
  std::uint32_t wedge_count = 0;    ///< wedges that its records add
  std::uint8_t deviation_code = 0;  ///< of the level after the chunk
  std::uint32_t checksum = 0;       ///< see checksum32
};

struct CompactGroup {
  Index material = 0;
  Index base_face_count = 0;
};

struct CompactHeader {
  std::uint32_t header_bytes = 0;  ///< up to the first chunk
  int grid_bits = 0;
  bool lossless = false;  ///< see rest_coder.h
  CompactCoding coding = CompactCoding::Small;
  CompactGrid grid;
  std::vector<CompactGroup> groups;
  std::vector<AttributeSpec> attributes;
  Index base_vertex_count = 0;
  Index base_wedge_count = 0;
  ErrorScale deviation;
  ErrorScale curvature;
  std::vector<CompactChunkEntry> chunks;

  /// How far apart the grid's points lie on an axis, mesh units.
  double step() const;
  bool is_fast() const { return coding == CompactCoding::Fast; }
  /// The position at a point of the grid.
  Vec3f place(const Vec3i& point) const;
  std::uint64_t base_face_count() const;
  /// Of the full mesh.
  std::uint64_t face_count() const;
  std::uint64_t wedge_count() const;
  std::uint64_t vertex_count() const;
  /// Numbers of all attributes of a wedge.
  std::uint64_t numbers_each() const;
  /// The fewest bytes that a chunk has; the first one holds the base mesh, too.
  std::uint64_t least_bytes(const CompactChunkEntry& chunk, bool is_first) const;
};

/// Returns where the chunks lie, and what they lead to.
std::vector<CompactChunk> compact_chunks(const CompactHeader& header);

/// Writes a header and its checksum.
std::vector<std::byte> write_compact_header(const CompactHeader& header);
/// Reads and checks a header: counts are within the limits that the chunks' lengths set.
Result<CompactHeader> read_compact_header(std::span<const std::byte> bytes);

/// Codes the errors of a level, which never rise but for where a stage begins.
class ErrorCoder {
 public:
  /// Codes the deviation of a level at the end of a stage, and what deviations fall from after it. False where the
  /// latter is less.
  bool code_stage_end(BitCoder& coder, int& deviation, int& after);
  /// Codes a level's codes; a reader's are set. False where what is read rises.
  bool code(BitCoder& coder, int& deviation, int& curvature);

 private:
  static bool code(BitCoder& coder, NumberCoder& numbers, int& last, int& error);
  NumberCoder deviations_, curvatures_;
  int deviation_ = 255, curvature_ = 255;
};

}  // namespace lodestone::detail

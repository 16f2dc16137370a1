#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/lod/progressive_mesh.h>

#include "codec/bit_coder.h"
#include "codec/compact_layout.h"
#include "codec/level_coder.h"
#include "codec/rest_coder.h"
#include "stream/growing_mesh.h"

namespace lodestone::detail {

/// Builds a progressive mesh chunk by chunk, each in one go. After each the mesh is whole: valid, its last position the
/// level that the chunk leads to. What is there already never changes, but for the faces of groups and the room of
/// arrays.
class CompactDecoder {
 public:
  /// Pre: `mesh` is empty and outlives the decoder. It may take `most_bytes`; more is an error.
  CompactDecoder(CompactHeader header, ProgressiveMesh& mesh, std::uint64_t most_bytes = kNoLimit);

  const CompactHeader& header() const { return header_; }
  /// Has all rounds from now on, the base mesh as one, appended to a list, which outlives the decoder.
  void count_rounds(std::vector<CompactRound>& rounds);

  /// How many chunks have been added.
  std::size_t chunk_count() const { return chunk_count_; }
  /// Whether all chunks have been added.
  bool done() const { return chunk_count_ == header_.chunks.size(); }

  /// Adds the next chunk. After an error the mesh is what it was before, and no chunk can be added any more: the models
  /// are not. Pre: not done(), no error before. Errors: Malformed, LimitExceeded.
  Result<void> add_chunk(std::span<const std::byte> bytes);

 private:
  Result<void> read_chunk(const CompactChunkEntry& chunk, std::span<const std::byte> bytes);
  Result<void> check_base_bytes() const;
  Result<void> read_base(BitCoder& coder);
  Result<void> read_round(BitCoder& coder);
  Result<void> read_errors(BitCoder& coder);
  void start_round();
  void spend(const BitCoder& coder, double CompactSizes::*part);
  void pass_attributes(const BitCoder& coder);
  void end_round();
  void add_moves();
  Result<void> add_values(BitCoder& coder);
  void begin_mesh();
  void add_records();
  void add_record(std::size_t begin, std::size_t end);
  void add_sector(const SectorList::Sector& sector);

  CompactHeader header_;
  std::size_t chunk_count_ = 0;
  LevelCoder levels_;
  ErrorCoder errors_;
  std::optional<RestCoder> rests_;  // of a lossless stream
  std::uint64_t walked_ = 0;        // by rounds, see LevelCoder::size
  std::uint64_t most_walked_ = 0;
  int deviation_code_ = 0;
  int within_code_ = 0;             // of levels within the round that comes next
  bool stage_ends_ = false;         // with the round at hand
  std::vector<Index> slots_;        // by face of the level: in its group
  std::vector<Index> group_faces_;  // by group: of the level
  std::uint64_t polygon_base_ = 0;  // of the polygons of the round at hand
  ProgressiveMesh& mesh_;
  std::uint64_t most_bytes_;
  std::vector<CompactRound>* rounds_ = nullptr;  // counted, unless null
  double bits_at_ = 0;                           // where the last part of the chunk ended
};

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <lodestone/core/result.h>
#include <lodestone/lod/progressive_mesh.h>

#include "stream/growing_mesh.h"
#include "stream/stream_layout.h"
#include "stream/stream_records.h"

namespace lodestone::detail {

class ChunkValues;
class Values;

/// Builds a progressive mesh chunk by chunk, each in one go. After each the mesh is whole: valid, its last position the
/// level that the chunk leads to. What is there already never changes, but for the faces of groups and the room of
/// arrays.
class StreamDecoder {
 public:
  /// Pre: `mesh` is empty and outlives the decoder. It may take `most_bytes`; more is an error.
  StreamDecoder(StreamStart start, ProgressiveMesh& mesh, std::uint64_t most_bytes = kNoLimit);

  const StreamDirectory& directory() const { return start_.directory; }
  /// How many chunks have been added.
  std::size_t chunk_count() const { return chunk_count_; }
  /// Whether all chunks have been added.
  bool done() const { return chunk_count_ == start_.directory.chunks.size(); }

  /// Adds the next chunk. After an error the mesh is what it was before, and no chunk can be added any more. Pre: not
  /// done(), no error before. Errors: Malformed, LimitExceeded.
  Result<void> add_chunk(std::span<const std::byte> bytes);

 private:
  Result<void> read_chunk(const StreamChunk& entry, std::span<const std::byte> bytes);
  Result<void> check_values(std::size_t first_vertex, std::size_t first_error) const;
  Result<void> check_level(const StreamChunk& entry) const;
  std::uint64_t face_count() const;
  Result<void> add_base(const StreamChunk& entry, std::span<const std::byte> bytes);
  Result<void> read_attribute_table(const Column& column);
  Result<void> check_base_sizes(std::span<const Column> columns) const;
  Result<void> read_base_vertices(std::span<const Column> columns);
  void read_base_attributes(std::span<const Column> columns);
  Result<void> read_groups(const Column& table, const Column& corner_steps);
  void begin_records(const StreamChunk& entry);
  Result<void> add_records(const StreamChunk& entry, std::span<const std::byte> bytes);
  Result<void> read_rounds(const StreamChunk& entry, Values& sizes);
  Result<void> read_record(ChunkValues& values);
  Result<void> read_connectivity(std::size_t record, ChunkValues& values);
  Result<void> read_sector(std::uint32_t wedge_count, ChunkValues& values);
  Result<void> check_coarse_faces(std::uint32_t group) const;
  Result<void> read_slot(std::uint32_t group, bool first, std::uint32_t size, ChunkValues& values);
  void read_errors(ChunkValues& values);
  void read_position(std::size_t record, ChunkValues& values);
  void read_attributes(std::size_t record, ChunkValues& values);

  StreamStart start_;
  std::size_t chunk_count_ = 0;
  ProgressiveMesh& mesh_;
  std::uint64_t most_bytes_;
  std::optional<FaceReplay> faces_;
  PolygonTracer tracer_;
};

}  // namespace lodestone::detail

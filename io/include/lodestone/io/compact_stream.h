#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/progress.h>
#include <lodestone/core/result.h>
#include <lodestone/core/vec.h>
#include <lodestone/lod/placed_level.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// The major version of compact streams, which those before it are not.
inline constexpr std::uint16_t kCompactStreamVersion = 3;

/// How fine a grid of positions may be: bits along each edge.
inline constexpr int kLeastGridBits = 8;
inline constexpr int kMostGridBits = 16;

/// The cube whose grid positions are rounded to: equal for all meshes that must not come apart.
struct CompactGrid {
  Vec3f origin;     ///< its least corner
  float range = 1;  ///< its edge, > 0
};

/// How the bits of a compact stream are coded.
enum class CompactCoding {
  Small,  ///< by many models that are mixed, in the fewest bytes
  Fast    ///< by few, decoded in two fifths of the time, at about 1.5 bits more for each vertex, and 1 for an attribute
};

/// Settings of a compact stream. docs/compact-stream.md describes the format.
struct CompactOptions {
  int grid_bits = 14;               ///< positions become one of 2^this along each edge of the grid's cube, 8 to 16
  std::optional<CompactGrid> grid;  ///< unset: the mesh's own box
  int normal_bits = 10;             ///< of directions (NORMAL, TANGENT) as points of an octahedron, 2 to 24
  int texture_bits = 12;            ///< of texture coordinates, over their box, 2 to 24
  int weight_bits = 8;              ///< of joints' weights, 2 to 24; those of a wedge add up to 1
  int other_bits = 12;              ///< of other floats, over theirs, 2 to 24; integers stay as they are
  CompactCoding coding = CompactCoding::Small;
  bool lossless = false;  ///< keep floats bit for bit, beyond those grids, at two to four times the bytes
  Progress progress;
};

/// What the parts of a compact stream, or of some of it, take, in bits.
struct CompactSizes {
  double header = 0;     ///< and what chunks are rounded up by
  double base = 0;       ///< the base mesh
  double places = 0;     ///< where vertices appear, and the triangulations there
  double positions = 0;  ///< where they lie
  double moves = 0;      ///< where they go
  double wedges = 0;     ///< which wedges belong where
  double loose = 0;      ///< what is told face by face, with its positions
  double rests = 0;      ///< what rounding takes, in a lossless stream
  double errors = 0;
  std::vector<double> attributes;  ///< by attribute

  /// All together.
  double sum() const;
};

/// A progressive mesh as a compact stream.
struct CompactStream {
  std::vector<std::byte> bytes;
  CompactSizes sizes;
  std::size_t round_count = 0;
  std::size_t loose_count = 0;  ///< records that are told face by face: of pieces that vanish, or where sheets meet
  /// By vertex of the mesh given: its number in the mesh that the stream decodes to.
  std::vector<Index> vertex_numbers;
  /// The same of wedges.
  std::vector<Index> wedge_numbers;
};

/// A chunk of a compact stream: it refines the level that those before it lead to.
struct CompactChunk {
  std::uint64_t byte_offset = 0;  ///< from the start of the stream
  std::uint64_t byte_length = 0;
  Index record_begin = 0;          ///< first record; chunk 0 holds the base mesh, too
  Index record_count = 0;          ///< may be 0 in chunk 0
  std::uint64_t vertex_count = 0;  ///< of the level after the chunk
  std::uint64_t wedge_count = 0;   ///< of the level after the chunk
  std::uint64_t face_count = 0;    ///< of the level after the chunk
  float deviation = 0;             ///< bound of the level after the chunk, mesh units
};

/// Encodes a progressive mesh in few bytes: its positions rounded to a grid, its records put together in rounds that
/// may come in any order within themselves. The level after each round is one that `mesh` has, too, and so is its
/// deviation, to which twice what rounding moves a point by is added, rounded up by up to 9 %; the others have that of
/// the round that they lie in. Fewest bytes come of SimplifyOptions::dense_rounds.
///
/// Attributes are rounded, too, unless they are integers; their elements come back whole, one for each wedge.
///
/// Deterministic. Errors: InvalidArgument for options, and for positions outside the grid by more than half a step;
/// LimitExceeded where the mesh has more of anything than a stream can hold; Unsupported where records do not fit the
/// faces that they replace; Cancelled.
///
/// `levels`, coarse to fine, say where the vertices of some levels lie so that those are closer to the full mesh:
/// records after them move them on. Positions up to such a level are rounded the more coarsely the less precise they
/// need be. The deviation of what lies between two such levels is that of the mesh's own, and how far its vertices are
/// moved. Errors besides: InvalidArgument where a level is none of the mesh, or not finer than the one before.
Result<CompactStream> encode_compact(const ProgressiveMesh& mesh, const CompactOptions& options = {},
                                     std::span<const PlacedLevel> levels = {});

/// Reads where the chunks lie and what they lead to; they need not be there yet. Errors: Malformed, Unsupported
/// (another version), with offsets.
Result<std::vector<CompactChunk>> read_compact_chunks(std::span<const std::byte> bytes);

/// A round of a compact stream, and the level that it leads to.
struct CompactRound {
  std::size_t chunk = 0;           ///< that it is in
  std::size_t record_count = 0;    ///< 0 of the first round, which is the base mesh
  std::size_t loose_count = 0;     ///< of them: see CompactStream
  std::uint64_t vertex_count = 0;  ///< of the level
  std::uint64_t face_count = 0;    ///< of the level
  float deviation = 0;             ///< bound of the level, mesh units
  CompactSizes sizes;              ///< of the round; none for a header
};

/// What a compact stream spends its bytes on.
struct CompactParts {
  CompactCoding coding = CompactCoding::Small;
  CompactSizes sizes;  ///< of the bytes given: 8 bits of each, all in all
  std::vector<std::string> attributes;
  std::vector<CompactRound> rounds;
};

/// Decodes a stream as `decode_compact` does, whole or its first chunks, and says what its parts take. Errors: the
/// same.
Result<CompactParts> measure_compact(std::span<const std::byte> bytes);

/// Decodes a stream, or its first chunks where `bytes` ends early on a chunk's boundary. The result is valid whatever
/// the bytes, and the same on every machine. Errors: Malformed, LimitExceeded, Unsupported, with offsets.
Result<ProgressiveMesh> decode_compact(std::span<const std::byte> bytes);

}  // namespace lodestone

// decode_compact: as it comes, and with the checksums made right again, so that what stands behind them is reached.
// What decodes must be valid, and the same in pieces.

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <lodestone/io/compact_stream.h>
#include <lodestone/lod/simplify.h>

#include "support/fuzz.h"
#include "support/fuzz_reader.h"
#include "support/placed_shapes.h"
#include "support/shapes.h"

namespace {

using lodestone::test::Bytes;

constexpr std::size_t kFixedBytes = 16, kChecksumBytes = 4, kFieldBytes = 2 + 4 * 4;
constexpr unsigned kFloat = 5126, kDirections = 1;

std::uint32_t checksum(const Bytes& bytes, std::size_t at, std::size_t size) {
  return static_cast<std::uint32_t>(XXH64(bytes.data() + at, size, 0));
}

void put(Bytes& bytes, std::size_t at, std::uint32_t value) { std::memcpy(bytes.data() + at, &value, sizeof value); }

/// Walks over the header as far as it goes and makes the checksums of the chunks right, then its own.
void seal(Bytes& bytes) {
  std::uint32_t header_bytes = 0;
  if (bytes.size() < kFixedBytes) return;
  std::memcpy(&header_bytes, bytes.data() + 12, sizeof header_bytes);
  if (header_bytes > bytes.size() || header_bytes < kFixedBytes + kChecksumBytes) return;
  const std::size_t end = header_bytes - kChecksumBytes;
  std::size_t at = kFixedBytes + kFieldBytes;
  const auto varint = [&] {
    std::uint64_t value = 0;
    for (unsigned shift = 0; at < end && shift < 63; shift += 7) {
      const std::uint8_t byte = bytes[at++];
      value |= std::uint64_t{byte & 127U} << shift;
      if (byte < 128) break;
    }
    return value;
  };
  const auto byte = [&] { return at < end ? bytes[at++] : std::uint8_t{0}; };
  for (std::uint64_t groups = varint(); groups-- > 0 && at < end;) varint(), varint();
  for (std::uint64_t attributes = varint(); attributes-- > 0 && at < end;) {
    at += static_cast<std::size_t>(std::min<std::uint64_t>(varint(), end));
    const unsigned type = byte() | unsigned{byte()} << 8U;
    const unsigned components = byte();
    byte();
    const unsigned coding = byte();
    byte();
    if (type == kFloat && coding != kDirections) at += (components + 1) * sizeof(float);
  }
  varint(), varint();
  at += 2 * sizeof(float);
  std::uint64_t offset = header_bytes;
  for (std::uint64_t chunks = at < end ? varint() : 0; chunks-- > 0 && at < end;) {
    const std::uint64_t length = varint();
    for (int i = 0; i < 4; ++i) varint();
    ++at;  // deviation
    if (at + 4 > end) break;
    if (offset <= bytes.size() && length <= bytes.size() - offset)
      put(bytes, at, checksum(bytes, static_cast<std::size_t>(offset), static_cast<std::size_t>(length)));
    at += 4;
    offset += length;
    if (offset > bytes.size()) break;
  }
  put(bytes, end, checksum(bytes, 0, end));
}

void decode(const Bytes& bytes) {
  const auto mesh = lodestone::decode_compact(std::as_bytes(std::span(bytes)));
  if (!mesh && mesh.error().message.empty()) std::abort();
  if (mesh) lodestone::test::require_valid(*mesh);
  lodestone::test::check_in_pieces(std::as_bytes(std::span(bytes)), mesh);
}

}  // namespace

std::vector<Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const TriangleSoup& soup :
       {tetrahedron(), icosphere(2, 0.05, 1), fan(9, 0.5), grid(9, 0.1, 1), torus(12, 8), annulus(9, 3), terrain(20, 1),
        seam_cube(3), seam_sphere(8, 6), slit_grid(8), two_material_sphere(2), faceted_sphere(1),
        skinned_cylinder(8, 6), morph_grid(6), spheres_at_a_vertex(1), cubes_at_an_edge(2), many_components(3),
        random_squares(3, 1), stacked(grid(4, 0.1, 1), 2)})
    for (const double dense_rounds : {0.0, 2.0}) {
      const auto assembled = assemble(soup);
      SimplifyOptions options;
      options.dense_rounds = dense_rounds;
      options.vanish = dense_rounds > 0;
      const auto result = simplify(assembled->mesh, options);
      CompactOptions compact;
      compact.grid_bits = dense_rounds > 0 ? 16 : 9;
      const auto stream = result ? encode_compact(result->mesh, compact) : fail(ErrorCode::Malformed, "");
      if (!stream) continue;
      seeds.push_back(bytes_of(stream->bytes));
      CompactOptions lossless = compact;
      lossless.lossless = true;
      if (const auto kept = encode_compact(result->mesh, lossless)) seeds.push_back(bytes_of(kept->bytes));
      const auto levels = scattered_levels(result->mesh, 2, 0.02, dense_rounds * 0.01, 1);
      if (const auto placed = encode_compact(result->mesh, compact, levels)) seeds.push_back(bytes_of(placed->bytes));
      compact.coding = CompactCoding::Fast;
      if (const auto fast = encode_compact(result->mesh, compact, levels)) seeds.push_back(bytes_of(fast->bytes));
    }
  return seeds;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, data + size);
  decode(bytes);
  seal(bytes);
  decode(bytes);
  return 0;
}

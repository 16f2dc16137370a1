// decode_stream: as it comes, and with the checksums made right again, so that what stands behind them is reached.
// What decodes must be valid, and the same in pieces.

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdlib>
#include <cstring>

#include <lodestone/io/stream_format.h>
#include <lodestone/lod/simplify.h>

#include "support/fuzz.h"
#include "support/fuzz_reader.h"
#include "support/shapes.h"

namespace {

using lodestone::test::Bytes;

constexpr std::size_t kFixedBytes = 64, kEntryBytes = 64, kChecksumBytes = 8;

template <class T>
T get(const Bytes& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void put(Bytes& bytes, std::size_t at, std::uint64_t value) { std::memcpy(bytes.data() + at, &value, sizeof value); }

/// Recomputes the checksums of all chunks that are there, then the header's.
void seal(Bytes& bytes) {
  if (bytes.size() < kFixedBytes) return;
  const std::size_t chunk_count = get<std::uint32_t>(bytes, 24), header_bytes = get<std::uint32_t>(bytes, 12);
  if (header_bytes > bytes.size() || header_bytes < kFixedBytes + kChecksumBytes) return;
  for (std::size_t i = 0; i < chunk_count; ++i) {
    const std::size_t entry = kFixedBytes + i * kEntryBytes;
    if (entry + kEntryBytes > header_bytes) break;
    const auto offset = get<std::uint64_t>(bytes, entry), length = get<std::uint64_t>(bytes, entry + 8);
    if (offset > bytes.size() || length > bytes.size() - offset) continue;
    put(bytes, entry + 24, XXH64(bytes.data() + offset, length, 0));
  }
  put(bytes, header_bytes - kChecksumBytes, XXH64(bytes.data(), header_bytes - kChecksumBytes, 0));
}

void decode(const Bytes& bytes) {
  const auto mesh = lodestone::decode_stream(std::as_bytes(std::span(bytes)));
  if (!mesh && mesh.error().message.empty()) std::abort();
  if (mesh) lodestone::test::require_valid(*mesh);
  lodestone::test::check_in_pieces(std::as_bytes(std::span(bytes)), mesh);
}

}  // namespace

std::vector<Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const TriangleSoup& soup :
       {tetrahedron(), seam_cube(2), two_material_sphere(1), seam_sphere(8, 6), fan(9, 0.5), grid(4, 0.1, 1)}) {
    const auto assembled = assemble(soup);
    const auto result = simplify(assembled->mesh);
    StreamOptions options;
    options.records_per_chunk = 12;
    const auto bytes = result ? encode_stream(result->mesh, options) : fail(ErrorCode::Malformed, "");
    if (!bytes) continue;
    seeds.push_back(bytes_of(*bytes));
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

#include "gltf/gltf_container.h"

#include <array>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "mesh/soup_file.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kGlbHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

struct Chunk {
  std::uint32_t type = 0;
  std::span<const std::byte> bytes;
};

Result<Chunk> read_chunk(std::span<const std::byte> bytes, std::size_t at) {
  const std::size_t room = bytes.size() - at;
  if (room < kChunkHeaderBytes) return fail(ErrorCode::Malformed, "glb: ends inside a chunk's header", at);
  const std::size_t size = load_u32(bytes, at);
  if (size > room - kChunkHeaderBytes)
    return fail(ErrorCode::Malformed,
                text("glb: chunk of ", size, " bytes exceeds the ", room - kChunkHeaderBytes, " bytes there are"), at);
  return Chunk{load_u32(bytes, at + 4), bytes.subspan(at + kChunkHeaderBytes, size)};
}

Result<GltfContainer> split_glb(std::span<const std::byte> bytes) {
  if (bytes.size() < kGlbHeaderBytes) return fail(ErrorCode::Malformed, "glb: ends inside the header");
  if (const auto version = load_u32(bytes, 4); version != 2)
    return fail(ErrorCode::Unsupported, text("glb: version ", version, " is not supported, only 2"), 4);
  const std::size_t length = load_u32(bytes, 8);
  if (length > bytes.size() || length < kGlbHeaderBytes)
    return fail(ErrorCode::Malformed, text("glb: length ", length, " where the file has ", bytes.size(), " bytes"), 8);

  LODESTONE_TRY(const Chunk json, read_chunk(bytes.first(length), kGlbHeaderBytes));
  if (json.type != kGlbJsonChunk)
    return fail(ErrorCode::Malformed, "glb: the first chunk is not JSON", kGlbHeaderBytes);
  GltfContainer container{as_text(json.bytes), {}};
  // Chunks begin on multiples of 4; some writers do not count the padding.
  const std::size_t next = padded_to_four(kGlbHeaderBytes + kChunkHeaderBytes + json.bytes.size());
  if (next >= length) return container;
  LODESTONE_TRY(const Chunk second, read_chunk(bytes.first(length), next));
  if (second.type == kGlbBinaryChunk) container.binary = second.bytes;
  return container;
}

/// Returns 0 to 63, or −1.
int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

Result<std::vector<std::byte>> decode_base64(std::string_view source, std::string_view where) {
  while (source.ends_with('=')) source.remove_suffix(1);
  std::vector<std::byte> bytes;
  bytes.reserve(source.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : source) {
    const int value = base64_value(c);
    if (value < 0) return fail(ErrorCode::Malformed, text(where, ": the data URI is not base64"));
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> bit_count));
  }
  return bytes;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Replaces %20 and the like; what is no such code stays as it is.
std::string decode_percent(std::string_view source) {
  std::string out;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const bool coded =
        source[i] == '%' && i + 2 < source.size() && hex_value(source[i + 1]) >= 0 && hex_value(source[i + 2]) >= 0;
    out += coded ? static_cast<char>(hex_value(source[i + 1]) * 16 + hex_value(source[i + 2])) : source[i];
    if (coded) i += 2;
  }
  return out;
}

}  // namespace

bool is_glb(std::span<const std::byte> bytes) { return bytes.size() >= 4 && load_u32(bytes, 0) == kGlbMagic; }

Result<GltfContainer> split_container(std::span<const std::byte> bytes) {
  if (is_glb(bytes)) return split_glb(bytes);
  return GltfContainer{as_text(bytes), {}};
}

Result<std::vector<std::byte>> decode_data_uri(std::string_view uri, std::string_view where) {
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos || !uri.substr(0, comma).ends_with(";base64"))
    return fail(ErrorCode::Malformed, text(where, ": the data URI is not base64"));
  return decode_base64(uri.substr(comma + 1), where);
}

Result<std::filesystem::path> uri_to_path(std::string_view uri, std::string_view where) {
  const std::string decoded = decode_percent(uri);
  const std::filesystem::path path(decoded);
  bool inside = !path.empty() && path.is_relative() && decoded.find_first_of(":\\") == decoded.npos &&
                decoded.find('\0') == decoded.npos;
  for (const auto& part : path) inside &= part != "..";
  if (inside) return path;
  return fail(ErrorCode::Unsupported, text(where, ": '", decoded, "' is not a file beside or below the document"));
}

}  // namespace lodestone::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::detail {

inline constexpr std::uint32_t kGlbMagic = 0x46546C67;        // "glTF"
inline constexpr std::uint32_t kGlbJsonChunk = 0x4E4F534A;    // "JSON"
inline constexpr std::uint32_t kGlbBinaryChunk = 0x004E4942;  // "BIN\0"

bool is_glb(std::span<const std::byte> bytes);

/// The two parts of a glTF file; the binary chunk is empty for a .gltf.
struct GltfContainer {
  std::string_view json;
  std::span<const std::byte> binary;
};

/// Splits a .glb into its chunks, or takes all of a .gltf as JSON. Errors: Malformed, Unsupported (version 1).
Result<GltfContainer> split_container(std::span<const std::byte> bytes);

/// Returns the bytes of a "data:" URI.
Result<std::vector<std::byte>> decode_data_uri(std::string_view uri, std::string_view where);

/// Returns the path a buffer's URI means: decoded, relative, beside or below the .gltf. Errors: Unsupported for others.
Result<std::filesystem::path> uri_to_path(std::string_view uri, std::string_view where);

}  // namespace lodestone::detail

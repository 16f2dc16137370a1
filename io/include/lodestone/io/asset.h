#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// One discrete level of an asset, finest first.
struct AssetLevel {
  Mesh mesh;
  Deviation deviation;         ///< measured against the full mesh
  double curvature_error = 0;  ///< of the metric's own unit
  std::string stop_reason;     ///< e.g. "faces", "error", "stuck"; goes to extras
};

struct AssetOptions {
  bool draco = true;
  int draco_position_bits = 14;  ///< 1 to 30, one grid for all levels and meshes
  int draco_normal_bits = 10;
  int draco_texcoord_bits = 12;
  int draco_generic_bits = 10;
  int draco_compression_level = 7;  ///< 0 to 10
  std::string name;                 ///< of the root node and its meshes
};

/// What was written, for reports.
struct AssetLayout {
  struct Level {
    std::uint64_t byte_offset = 0;  ///< in the binary chunk
    std::uint64_t byte_length = 0;
    std::uint64_t face_count = 0;    ///< as decoded
    std::uint64_t vertex_count = 0;  ///< as decoded
  };
  std::vector<Level> levels;
  std::uint64_t stream_bytes = 0;
  std::uint64_t total_bytes = 0;
};

struct EncodedAsset {
  std::vector<std::byte> glb;
  AssetLayout layout;
};

/// Encodes a multi-LOD .glb: MSFT_lod levels, their numbers in extras, Draco or plain geometry, and the removal stream
/// (if any) as the optional extension LODESTONE_removal_stream. The binary chunk holds the coarsest level first and the
/// stream last. Deterministic. Errors: InvalidArgument, Unsupported.
Result<EncodedAsset> encode_asset(std::span<const AssetLevel> levels, std::span<const std::byte> stream,
                                  const AssetOptions& options);

/// A multi-LOD file as read back.
struct Asset {
  struct Level {
    Mesh mesh;  ///< decoded from Draco or plain accessors
    std::uint64_t byte_length = 0;
    double maximum_deviation = 0;  ///< from extras, mesh units; 0 where absent
    double mean_deviation = 0;
    double rms_deviation = 0;
    double curvature_error = 0;
    double screen_coverage = 0;
    bool draco = false;
  };
  std::vector<Level> levels;      ///< finest first; one for an ordinary glTF
  std::vector<std::byte> stream;  ///< empty where the file has none
  std::uint64_t total_bytes = 0;
};

/// Reads the levels and the stream of a .glb that `encode_asset` wrote.
/// Errors: Unreadable, Malformed, LimitExceeded, Unsupported.
Result<Asset> read_asset(const std::filesystem::path& path);

/// Reads the same from memory. Errors: Malformed, LimitExceeded, Unsupported.
Result<Asset> read_asset_bytes(std::span<const std::byte> bytes);

/// Reads only the removal stream of a .glb. Errors: as above; Unsupported where the file has none.
Result<std::vector<std::byte>> read_asset_stream(const std::filesystem::path& path);

}  // namespace lodestone

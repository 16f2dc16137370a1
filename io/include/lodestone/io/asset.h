#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>
#include <lodestone/core/result.h>
#include <lodestone/lod/deviation.h>

namespace lodestone {

/// One discrete level of a mesh.
struct AssetLevel {
  Mesh mesh;
  Deviation deviation;          ///< measured against the full mesh; goes to extras, as the next
  double curvature_error = 0;   ///< of the metric's own unit
  std::string stop_reason;      ///< e.g. "faces", "error", "stuck"
  double deviation_beyond = 0;  ///< a bound had the level gone on to the faces asked for; 0: it did, or knows none
};

/// A grid that positions are quantised in, whatever the meshes: files made one by one agree where their meshes meet.
struct PositionGrid {
  Vec3f origin;    ///< mesh units, as the next
  float step = 0;  ///< > 0; no position lies farther than 2²⁹ steps from the origin, for meshopt 2²³
};

/// What geometry is compressed by. What is given as bits or a grid is for Draco and meshopt.
enum class Compression {
  None,     ///< plain accessors, everything as it is
  Draco,    ///< KHR_draco_mesh_compression: smallest
  Meshopt,  ///< EXT_meshopt_compression: decoded many times faster, packs morph targets, too
};

/// Returns "none", "draco" or "meshopt".
const char* name_of(Compression compression);

/// How a file stores its geometry.
///
/// Meshopt's grids have steps of powers of two, the next one below what is asked for, so that positions are floats
/// without a transform in the nodes; normals and tangents are stored as KHR_mesh_quantization allows.
struct AssetOptions {
  Compression compression = Compression::Draco;
  /// 1 to 30, one grid for all levels, and all meshes of a scale. Unset: 14, or what the finest parts of the shape and
  /// `position_error` need; where 23 do not do, positions stay the floats they are. Beyond 24, here or below,
  /// Draco codes no entropy, which would take four bytes for every step of the grid.
  std::optional<int> position_bits;
  /// The farthest that a vertex may move, world units.
  double position_error = std::numeric_limits<double>::infinity();
  std::optional<PositionGrid> position_grid;  ///< in place of a grid of so many bits, fitted to the meshes
  /// Of each of the two numbers that a normal is stored as; meshopt takes 16 at most, and tangents alike.
  int normal_bits = 10;
  int texcoord_bits = 12;  ///< of a texture's width: coordinates beyond it get more
  /// Of tangents' range, of colours' and weights' unit. All other attributes are data, which is kept exactly.
  int generic_bits = 10;
  int draco_compression_level = 7;  ///< 0 to 10
  /// Not empty: a .gltf of this name without its extension, its data in NAME.bin and its images as files beside it, in
  /// place of a .glb.
  std::string gltf_name;
  bool keep_decoded = false;  ///< keep the levels as clients will decode them: see `EncodedGeometry`
  Progress progress;          ///< of the encoding; where it is cancelled that ends with the error Cancelled
};

/// What was written, for reports.
struct AssetLayout {
  /// A level in the file.
  struct Level {
    std::uint64_t byte_offset = 0;     ///< in the binary chunk: of what only this level and finer ones need
    std::uint64_t byte_length = 0;     ///< of the same
    std::uint64_t geometry_bytes = 0;  ///< of all its geometry, that it shares with other levels included
    std::uint64_t face_count = 0;      ///< as decoded, all instances counted
    std::uint64_t vertex_count = 0;    ///< as decoded, all instances counted
  };
  std::vector<Level> levels;
  double quantisation_error = 0;  ///< the farthest that rounding to the grid moves a vertex, world units
  int position_bits = 0;          ///< of the finest grid; 0 where positions are exact
  std::uint64_t stream_bytes = 0;
  std::uint64_t total_bytes = 0;  ///< of all files together
  /// What has to be there before the coarsest level can be drawn, but for images: the document, and the binary data up
  /// to the level's end.
  std::uint64_t first_picture_bytes = 0;
  std::vector<std::string> notes;  ///< what is stored otherwise than asked for, one sentence each
};

/// A file that a .gltf refers to.
struct AssetFile {
  std::filesystem::path path;  ///< relative to the .gltf, beside or below it
  std::vector<std::byte> bytes;
};

/// The bytes of one asset, and where its parts lie in them.
struct EncodedAsset {
  std::vector<std::byte> glb;     ///< or the .gltf, where the options name one
  std::vector<AssetFile> beside;  ///< of a .gltf
  AssetLayout layout;
};

class Scene;

/// A glTF with levels of detail, opened: the one reader of such files, whoever made them. Geometry is decoded when it
/// is asked for. Copies share what was read.
class Asset {
 public:
  /// A level of the whole scene, flattened into world space.
  struct Level {
    Mesh mesh;                       ///< decoded from Draco or plain accessors, assembled: clean and without doubles
    Box box;                         ///< of all its faces, those without area included
    std::uint64_t face_count = 0;    ///< drawn, as stored
    std::uint64_t vertex_count = 0;  ///< drawn: of each mesh as `Scene` joins it
    std::uint64_t byte_length = 0;   ///< of its geometry, each mesh once
    double maximum_deviation = 0;    ///< from extras, world units: the largest of all meshes; 0 where absent
    double mean_deviation = 0;       ///< weighted by the area that each mesh covers in the world
    double rms_deviation = 0;        ///< weighted alike
    double curvature_error = 0;      ///< the largest
    double screen_coverage = 0;      ///< of the screen's height, the largest
    Compression compression = Compression::None;  ///< of any of its meshes
  };
  /// The removal stream of one mesh.
  struct Stream {
    std::string mesh;  ///< the name of its mesh
    std::vector<std::byte> bytes;
  };

  /// Opens a .glb or .gltf with its buffers, an ordinary one, too. Errors: Unreadable, Malformed, LimitExceeded,
  /// Unsupported.
  static Result<Asset> read(const std::filesystem::path& path);
  /// Opens the same from memory. Files beside it are out of reach.
  static Result<Asset> read_bytes(std::span<const std::byte> bytes);

  /// How many levels it has: 1 for an ordinary glTF.
  std::size_t level_count() const;
  /// Decodes all levels, finest first. Errors: Malformed, LimitExceeded, Unsupported.
  Result<std::vector<Level>> levels() const;
  /// Returns the streams in the order of the meshes; none where the file has none. Errors: Malformed.
  Result<std::vector<Stream>> streams() const;
  /// Returns the scene that the levels were made of, its meshes as in one of them: 0 is the finest, which comes with
  /// its streams. Images beside the file are read here. Errors: as `Scene::read`; Unsupported where another program
  /// made the levels, InvalidArgument for a level that there is none of.
  Result<Scene> scene(std::size_t level = 0) const;
  /// Of the file, with what lies beside it.
  std::uint64_t total_bytes() const;

 private:
  struct Impl;
  explicit Asset(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

  std::shared_ptr<const Impl> impl_;
};

}  // namespace lodestone

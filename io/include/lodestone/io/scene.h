#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/read_mesh.h>

namespace lodestone {

/// One mesh of a scene: the triangles of all its primitives, joined.
///
/// The attributes are those of all primitives, zero where a primitive lacks one; an attribute that primitives have in
/// different types stands there once for each type. Morph targets travel as attributes "TARGET_<i>:<SEMANTIC>", floats.
struct SceneMesh {
  std::string name;                ///< may be empty
  Mesh mesh;                       ///< face_material: the number of the primitive in the document's mesh
  AssemblyReport assembly;         ///< what became of the triangles in the file
  double scale = 1;                ///< the largest stretch of any instance, ever, also by morph targets: world
                                   ///< units per mesh unit
  double area = 0;                 ///< of all its instances together when largest, squared world units
  std::size_t instance_count = 0;  ///< how often the scene shows it
  bool skinned = false;            ///< by any of its nodes
  bool has_targets = false;        ///< morph targets
  /// By morph target: the most that a displacement of length 1 is in the world beside a length 1 of the mesh. Targets
  /// count at the largest weight that they have at rest or that animations give them, and at 1 at least.
  std::vector<double> target_reach;
  std::vector<std::string> nodes;      ///< the names of the nodes that show it
  std::vector<std::string> materials;  ///< by number of the primitive: its material's name
  std::vector<std::byte> stream;       ///< its removal stream; only of the finest `Asset::scene`
};

/// A glTF document with all it holds, and the meshes of it that levels can be made of: those that have triangles and
/// that a node of a scene shows.
class Scene {
 public:
  /// Reads a scene from glTF or GLB with its buffers and images; any other format as `from_mesh` says.
  /// Errors: Unreadable, Malformed, LimitExceeded; Unsupported, also where the file has levels of detail already:
  /// `Asset` reads those.
  static Result<Scene> read(const std::filesystem::path& path);
  /// Reads the same from memory; `extension` as for `read_mesh_bytes`. Files beside it are out of reach.
  static Result<Scene> read_bytes(std::span<const std::byte> bytes, const std::string& extension);
  /// Makes a scene of one node and its mesh, with the file's materials that faces use, and plain ones for numbers that
  /// it does not describe; 0 stands for none, or for a plain one where vertices have colours.
  static Result<Scene> from_mesh(MeshFile file, const std::string& name);

  /// The meshes to make levels of, in the document's order.
  const std::vector<SceneMesh>& meshes() const;
  /// What became of the triangles of meshes that have none left, which stay in the document as they are.
  const std::vector<AssemblyReport>& dropped() const;
  /// What is left out of the scene or changed in it, one sentence each.
  const std::vector<std::string>& notes() const;
  /// The box of all instances in the world, each at rest or, where animations make it larger, when it is largest; of
  /// size 0 where there are none.
  const Box& box() const;
  /// Whether world units are metres: glTF says so, other formats say nothing.
  bool in_metres() const;
  /// The files beside it that were read, relative to its folder.
  const std::vector<std::filesystem::path>& files() const;

  struct Impl;  ///< opaque
  explicit Scene(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// The levels of one mesh of a scene.
struct LeveledMesh {
  /// Finest first, as many as every mesh of the scene has. Attributes and face_material as in SceneMesh; a level equal
  /// to the one before is stored once.
  std::vector<AssetLevel> levels;
  std::vector<std::byte> stream;  ///< the removal stream; empty for none
};

/// Returns the farthest that compression will move a vertex of each mesh, in mesh units, where its levels lie in the
/// box of the mesh; 0 without it.
std::vector<double> quantisation_errors(const Scene& scene, const AssetOptions& options);

/// Returns how each mesh's compact stream is to be encoded: meshes of equal scale share a grid, since they may touch;
/// it has the bits that the options say, or as many as the shapes need, 8 to 16. The options' own grid is not for
/// streams.
std::vector<CompactOptions> compact_options(const Scene& scene, const AssetOptions& options);

/// Returns of which meshes that grid is as fine as the options and shapes ask for.
std::vector<bool> fit_compact_streams(const Scene& scene, const AssetOptions& options);

/// What of the levels and streams given a file holds.
struct FileContent {
  std::optional<std::size_t> level;  ///< this one alone
  bool streams = true;
};

/// A scene whose levels are encoded, all but the numbers that the file states of them. Move-only.
class EncodedGeometry {
 public:
  struct Impl;  ///< opaque
  explicit EncodedGeometry(std::unique_ptr<Impl> impl);
  ~EncodedGeometry();
  EncodedGeometry(EncodedGeometry&&) noexcept;
  EncodedGeometry& operator=(EncodedGeometry&&) noexcept;

  /// By mesh and level, finest first: the numbers that `write_asset` will state, at first those given. The meshes are
  /// as clients will decode them where the options keep them, otherwise empty.
  std::vector<std::vector<AssetLevel>>& levels();

  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Encodes the levels of a scene's meshes, or one of them, which a stream may go with that refines it to the whole: the
/// first half of `encode_scene` and `encode_scene_level`, between which and the second the levels can be measured as
/// they come out of the file. Pre: one entry for each of the scene's meshes, which outlive what is returned. Errors: as
/// below.
Result<EncodedGeometry> encode_geometry(const Scene& scene, std::span<const LeveledMesh> meshes,
                                        const AssetOptions& options, const FileContent& content = {});

/// Writes the file around the levels, with their numbers: the second half.
Result<EncodedAsset> write_asset(EncodedGeometry geometry);

/// Encodes a scene as a multi-LOD .glb: everything in the document as it was, and levels by MSFT_lod below each node
/// that shows one of the meshes. The binary chunk holds the coarsest levels, what the document keeps, the finer levels
/// one after the other, and the streams (extension LODESTONE_removal_stream) last. Deterministic.
/// Pre: one entry for each of the scene's meshes. Errors: InvalidArgument, Malformed, LimitExceeded, Unsupported.
Result<EncodedAsset> encode_scene(const Scene& scene, std::span<const LeveledMesh> meshes, const AssetOptions& options);

/// Encodes a scene as a .glb that has only one of the levels, with neither MSFT_lod nor streams. Errors: as above.
Result<EncodedAsset> encode_scene_level(const Scene& scene, std::span<const LeveledMesh> meshes, std::size_t level,
                                        const AssetOptions& options);

/// Returns a level of the whole scene as one mesh: its meshes where its nodes show them at rest, as `read_mesh` reads a
/// file of that level. Pre: as `encode_scene_level`. Errors: the same, and LimitExceeded.
Result<Mesh> level_surface(const Scene& scene, std::span<const LeveledMesh> meshes, std::size_t level);

}  // namespace lodestone

#include <lodestone/io/asset.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <lodestone/core/assemble.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>
#include <lodestone/io/scene.h>

#include "base/files_beside.h"
#include "formats/loaded_bytes.h"
#include "gltf/gltf_flatten.h"
#include "gltf/gltf_primitive.h"
#include "gltf/gltf_scene.h"
#include "scene/scene_mesh.h"
#include "scene/scene_reader.h"
#include "scene/stream_extension.h"

namespace lodestone {
namespace {

using namespace detail;

/// Adds up what is said of one level in many places.
class LevelNumbers {
 public:
  /// Adds what a node's extras say. `scale` and `area` of its mesh stand with all its levels; files of one mesh may
  /// lack them.
  void add_node(const Json& node) {
    const Json* extras = find_member(node, "extras");
    const Json* numbers = extras != nullptr ? find_member(*extras, "lodestone") : nullptr;
    if (numbers != nullptr) add(*numbers, "maximum_deviation");
  }

  /// Adds what a mesh that shows a level of its stream says of that.
  void add_mesh(const Json& mesh) {
    if (shows_level_of_stream(mesh)) add(*GltfDocument::extension(mesh, kStreamExtension), "deviation");
  }

  void store(Asset::Level& level) const {
    level.maximum_deviation = maximum_;
    level.curvature_error = curvature_error_;
    if (!(area_ > 0)) return;
    level.mean_deviation = mean_ / area_;
    level.rms_deviation = std::sqrt(squares_ / area_);
  }

 private:
  void add(const Json& numbers, const char* maximum) {
    const double scale = number_member(numbers, "world_scale", 1), area = number_member(numbers, "world_area", 1);
    const double rms = number_member(numbers, "rms_deviation", 0) * scale;
    maximum_ = std::max(maximum_, number_member(numbers, maximum, 0) * scale);
    curvature_error_ = std::max(curvature_error_, number_member(numbers, "curvature_error", 0));
    mean_ += number_member(numbers, "mean_deviation", 0) * scale * area;
    squares_ += rms * rms * area;
    area_ += area;
  }

  double maximum_ = 0, curvature_error_ = 0;
  double mean_ = 0, squares_ = 0, area_ = 0;
};

/// Returns the entry of MSFT_screencoverage on the finest node; 0 where there is none.
double screen_coverage(const Json& finest, std::size_t level) {
  const Json* extras = find_member(finest, "extras");
  const Json* list = extras != nullptr ? find_member(*extras, "MSFT_screencoverage") : nullptr;
  if (list == nullptr || !list->is_array() || level >= list->size() || !(*list)[level].is_number()) return 0;
  return (*list)[level].get<double>();
}

/// What the meshes' geometry takes, each bufferView once, and how it is compressed.
struct StoredGeometry {
  std::uint64_t bytes = 0;
  Compression compression = Compression::None;
};

Result<StoredGeometry> stored_geometry(const GltfDocument& document, const std::set<std::size_t>& meshes) {
  StoredGeometry stored;
  std::set<std::size_t> views;
  for (const std::size_t mesh : meshes) {
    if (uses_draco(document, mesh)) stored.compression = Compression::Draco;
    LODESTONE_TRY(const auto of_mesh, geometry_views(document, mesh));
    views.insert(of_mesh.begin(), of_mesh.end());
  }
  for (const std::size_t number : views) {
    LODESTONE_TRY(const GltfDocument::StoredView view, document.stored_view(number));
    stored.bytes += view.byte_length;
    if (view.packed && stored.compression == Compression::None) stored.compression = Compression::Meshopt;
  }
  return stored;
}

using Chains = std::vector<std::vector<std::size_t>>;

Result<void> read_numbers(const GltfDocument& document, std::size_t index, const Chains& chains,
                          const std::set<std::size_t>& meshes, Asset::Level& level) {
  LevelNumbers numbers;
  for (const std::size_t mesh : meshes) {
    LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", mesh));
    numbers.add_mesh(*json);
  }
  for (const auto& chain : chains) {
    LODESTONE_TRY(const Json* const node, document.element("nodes", "node", chain[std::min(index, chain.size() - 1)]));
    numbers.add_node(*node);
    LODESTONE_TRY(const Json* const finest, document.element("nodes", "node", chain[0]));
    level.screen_coverage = std::max(level.screen_coverage, screen_coverage(*finest, index));
  }
  numbers.store(level);
  return {};
}

Box box_of(const TriangleSoup& soup) {
  Mesh points{soup.positions, {}, soup.indices, {}, {}};
  points.wedge_vertex.resize(points.positions.size());
  std::iota(points.wedge_vertex.begin(), points.wedge_vertex.end(), Index{0});
  return bounding_box(points);
}

Result<std::uint64_t> count_vertices(const GltfDocument& document, std::span<const MeshInstance> instances) {
  std::map<std::size_t, std::uint64_t> of_mesh;
  std::uint64_t count = 0;
  for (const MeshInstance& instance : instances) {
    if (!of_mesh.contains(instance.mesh)) {
      LODESTONE_TRY(const auto joined, join_primitives(document, instance.mesh));
      of_mesh[instance.mesh] = joined ? joined->mesh.mesh.vertex_count() : 0;
    }
    count += of_mesh[instance.mesh];
  }
  return count;
}

Result<Asset::Level> read_level(const GltfDocument& document, std::size_t index, const Chains& chains) {
  Asset::Level level;
  LODESTONE_TRY(const SoupFile file, flatten_scene(document, index));
  level.box = box_of(file.soup);
  level.face_count = file.soup.indices.size() / 3;
  LODESTONE_TRY(AssembledMesh assembled, assemble(file.soup));
  level.mesh = std::move(assembled.mesh);

  LODESTONE_TRY(const auto instances, collect_instances(document, index));
  std::set<std::size_t> meshes;
  for (const MeshInstance& instance : instances) meshes.insert(instance.mesh);
  LODESTONE_TRY(level.vertex_count, count_vertices(document, instances));
  LODESTONE_TRY(const StoredGeometry stored, stored_geometry(document, meshes));
  level.byte_length = stored.bytes;
  level.compression = stored.compression;
  LODESTONE_CHECK(read_numbers(document, index, chains, meshes, level));
  return level;
}

Result<std::vector<Asset::Level>> read_levels(const GltfDocument& document, std::size_t count) {
  LODESTONE_TRY(const auto chains, lod_chains(document));
  std::vector<Asset::Level> levels;
  for (std::size_t i = 0; i < count; ++i) {
    LODESTONE_TRY(Asset::Level level, read_level(document, i, chains));
    levels.push_back(std::move(level));
  }
  return levels;
}

Result<std::vector<Asset::Stream>> read_streams(const GltfDocument& document, const FileFetcher& fetch) {
  std::vector<Asset::Stream> streams;
  std::set<std::filesystem::path> files;
  // A small file cannot ask for a large one again and again.
  const auto fetch_once = [&](const std::filesystem::path& path) -> Result<std::vector<std::byte>> {
    if (!files.insert(path).second)
      return fail(ErrorCode::Malformed, text("two meshes have their stream in '", path.string(), "'"));
    return fetch(path);
  };
  for (std::size_t i = 0; i < document.count("meshes"); ++i) {
    LODESTONE_TRY(std::vector<std::byte> stream, stored_stream(document, i, fetch_once));
    if (stream.empty()) continue;
    LODESTONE_TRY(const Json* const mesh, document.element("meshes", "mesh", i));
    streams.push_back({string_member(*mesh, "name"), std::move(stream)});
  }
  return streams;
}

}  // namespace

struct Asset::Impl {
  OpenedGltf gltf;
  std::size_t level_count = 1;
  std::uint64_t total_bytes = 0;
  std::filesystem::path path;  ///< empty for what was read from memory

  static Result<Impl> open(std::span<const std::byte> bytes, FileFetcher fetch) {
    Impl impl;
    LODESTONE_TRY(impl.gltf, open_gltf(bytes, std::move(fetch)));
    LODESTONE_TRY(impl.level_count, lodestone::detail::level_count(impl.gltf.document));
    impl.total_bytes = bytes.size();
    return impl;
  }

  /// Has an error say which file it is of.
  template <class T>
  Result<T> named(Result<T> result) const {
    if (result || path.empty()) return result;
    return tl::unexpected<Error>(with_path(std::move(result).error(), path));
  }
};

Result<Asset> Asset::read(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  auto opened = Impl::open(bytes, files_beside(path));
  if (!opened) return tl::unexpected<Error>(with_path(std::move(opened).error(), path));
  opened->path = path;
  opened->total_bytes += bytes_beside(opened->gltf.document.json(), path);
  return Asset(std::make_shared<const Impl>(std::move(*opened)));
}

Result<Asset> Asset::read_bytes(std::span<const std::byte> bytes) {
  LODESTONE_TRY(Impl opened, Impl::open(bytes, nothing_beside));
  return Asset(std::make_shared<const Impl>(std::move(opened)));
}

const char* name_of(Compression compression) {
  switch (compression) {
    case Compression::Draco:
      return "draco";
    case Compression::Meshopt:
      return "meshopt";
    case Compression::None:
      break;
  }
  return "none";
}

std::size_t Asset::level_count() const { return impl_->level_count; }

Result<std::vector<Asset::Level>> Asset::levels() const {
  return impl_->named(read_levels(impl_->gltf.document, impl_->level_count));
}

Result<std::vector<Asset::Stream>> Asset::streams() const {
  return impl_->named(read_streams(impl_->gltf.document, impl_->gltf.fetch));
}

Result<Scene> Asset::scene(std::size_t level) const { return impl_->named(scene_of_level(impl_->gltf, level)); }

std::uint64_t Asset::total_bytes() const { return impl_->total_bytes; }

}  // namespace lodestone

// A .glb of a whole scene: the document as it was, its meshes replaced by levels that MSFT_lod ties together below the
// nodes that show them, geometry plain or Draco, the removal streams last.

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <lodestone/core/detail/cancelled.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/screen_coverage.h>

#include "base/bytes.h"
#include "gltf/glb_builder.h"
#include "scene/draco_levels.h"
#include "scene/meshopt_accessors.h"
#include "scene/scene_buffers.h"
#include "scene/scene_channels.h"
#include "scene/scene_extensions.h"
#include "scene/scene_files.h"
#include "scene/scene_grids.h"
#include "scene/scene_impl.h"
#include "scene/scene_levels.h"
#include "scene/scene_materials.h"
#include "scene/scene_mending.h"
#include "scene/scene_nodes.h"
#include "scene/scene_objects.h"
#include "scene/scene_primitives.h"
#include "scene/stream_extension.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr int kMaxQuantizationBits = 30;  // Draco's limit
constexpr int kMinNormalBits = 2;

constexpr double kEncodingShare = .9;  // of the time that a level takes to be encoded and described

// Of a grid's step: floats hold all that Draco computes from it.
constexpr float kLeastStep = 1e-30F, kMostStep = 1e28F;

struct BitsOption {
  const char* name;
  int value;
  int least;
};

Result<void> check_options(const AssetOptions& options) {
  if (options.compression == Compression::None) return {};
  for (const BitsOption& bits :
       {BitsOption{"position_bits", options.position_bits.value_or(1), 1},
        BitsOption{"normal_bits", options.normal_bits, kMinNormalBits},
        BitsOption{"texcoord_bits", options.texcoord_bits, 1}, BitsOption{"generic_bits", options.generic_bits, 1}})
    if (bits.value < bits.least || bits.value > kMaxQuantizationBits)
      return fail(ErrorCode::InvalidArgument,
                  text(bits.name, " is ", bits.value, ", not in ", bits.least, " to ", kMaxQuantizationBits));
  if (const auto& grid = options.position_grid; grid && !(grid->step >= kLeastStep && grid->step <= kMostStep))
    return fail(ErrorCode::InvalidArgument,
                text("the grid's step is ", grid->step, ", not in ", kLeastStep, " to ", kMostStep));
  const Vec3f origin = options.position_grid ? options.position_grid->origin : Vec3f{};
  if (options.compression == Compression::Meshopt && !(origin == Vec3f{}))
    return fail(ErrorCode::InvalidArgument, "meshopt's grids count from 0: the grid's origin cannot be another");
  if (options.draco_compression_level < 0 || options.draco_compression_level > 10)
    return fail(ErrorCode::InvalidArgument,
                text("draco_compression_level is ", options.draco_compression_level, ", not in 0 to 10"));
  return {};
}

/// The levels to write: all that each mesh has, or one of them.
struct LevelRange {
  std::size_t first = 0;
  std::size_t count = 1;
  bool is_picked = false;  ///< one of them, which a stream may refine
};

Result<LevelRange> all_levels(const Scene& scene, std::span<const LeveledMesh> meshes) {
  if (meshes.size() != scene.meshes().size())
    return fail(ErrorCode::InvalidArgument,
                text("levels of ", meshes.size(), " meshes for a scene of ", scene.meshes().size()));
  if (meshes.empty()) return LevelRange{};
  const std::size_t count = meshes[0].levels.size();
  if (count == 0) return fail(ErrorCode::InvalidArgument, "a mesh needs at least one level");
  for (const LeveledMesh& mesh : meshes)
    if (mesh.levels.size() != count)
      return fail(ErrorCode::InvalidArgument, text("meshes of ", count, " and of ", mesh.levels.size(), " levels"));
  return LevelRange{0, count, false};
}

/// Writes the file part by part, in the order in which its bytes come.
class SceneWriter {
 public:
  SceneWriter(const Scene& scene, std::span<const LeveledMesh> meshes, LevelRange range, bool with_streams,
              const AssetOptions& options)
      : scene_(scene),
        impl_(scene_.impl()),
        meshes_(meshes),
        range_(range),
        with_streams_(with_streams),
        options_(options),
        plan_(plan_buffers(impl_, !options.gltf_name.empty())),
        builder_(impl_.document.json(), plan_.free_slots),
        materials_(builder_),
        lower_meshes_(meshes.size()),
        written_(meshes.size(), std::vector<WrittenLevel>(range.count)) {}

  Result<void> encode() {
    LODESTONE_CHECK(prepare());
    for (std::size_t level = range_.count; level-- > 0;) {
      LODESTONE_CHECK(add_level(level));
      if (level + 1 < range_.count) continue;
      LODESTONE_CHECK(copy_kept_views(impl_.document, plan_, builder_));
      LODESTONE_CHECK(place_images());
    }
    note_collapsed();
    list_levels();
    return {};
  }

  std::vector<std::vector<AssetLevel>>& levels() { return levels_; }

  Result<EncodedAsset> write() {
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) add_finest(mesh);
    if (with_streams_)
      for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) add_stream(mesh);
    choose_coverages();
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh)
      for (const std::size_t node : impl_.sources[mesh].nodes) add_nodes(mesh, node);
    move_channels();
    return finish();
  }

 private:
  Result<void> place_images() {
    if (options_.gltf_name.empty()) {
      embed_images(impl_.images, builder_);
    } else {
      LODESTONE_TRY(beside_, put_images_beside(impl_, options_.gltf_name, builder_));
    }
    return {};
  }

  Result<EncodedAsset> finish() {
    EncodedAsset asset{{}, std::move(beside_), std::move(layout_)};
    const std::uint64_t binary_bytes = padded_to_four(builder_.binary_bytes());
    std::uint64_t document_bytes = 0;
    if (options_.gltf_name.empty()) {
      LODESTONE_TRY(asset.glb, builder_.finish());
      document_bytes = asset.glb.size() - binary_bytes;
    } else {
      const std::string data = options_.gltf_name + ".bin";
      GlbBuilder::SeparateFiles files = builder_.finish_separate(uri_of(data));
      const auto json = std::as_bytes(std::span(files.json));
      asset.glb.assign(json.begin(), json.end());
      if (!files.binary.empty()) asset.beside.insert(asset.beside.begin(), {data, std::move(files.binary)});
      document_bytes = asset.glb.size();
    }
    const AssetLayout::Level& coarsest = asset.layout.levels.back();
    asset.layout.first_picture_bytes = document_bytes + coarsest.byte_offset + coarsest.byte_length;
    asset.layout.total_bytes = asset.glb.size();
    for (const AssetFile& file : asset.beside) asset.layout.total_bytes += file.bytes.size();
    return asset;
  }

  const AssetLevel& level_of(std::size_t mesh, std::size_t level) const {
    return meshes_[mesh].levels[range_.first + level];
  }

  Result<void> prepare() {
    builder_.document()["asset"]["generator"] = kGenerator;
    drop_replaced_extensions(impl_, builder_.document());
    layout_.levels.resize(range_.count);
    collapsed_.resize(range_.count);
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
      geometry_.emplace_back();
      for (std::size_t level = 0; level < range_.count; ++level) {
        LODESTONE_TRY(LevelGeometry matched, match_level(level_of(mesh, level).mesh, impl_.sources[mesh]));
        if (range_.first + level > 0) mend_attributes(impl_.sources[mesh], matched);
        geometry_.back().push_back(std::move(matched));
      }
    }
    LODESTONE_TRY(grids_, fit_grids(scene_, geometry_, options_));
    if (options_.compression == Compression::Meshopt) round_levels();
    LODESTONE_CHECK(encode_levels_side_by_side());
    for (std::size_t mesh = 0; options_.compression != Compression::None && mesh < meshes_.size(); ++mesh) {
      const QuantizationGrid& grid = grids_[mesh].position;
      layout_.quantisation_error =
          std::max(layout_.quantisation_error, grid.point_error() * scene_.meshes()[mesh].scale);
      layout_.position_bits = std::max(layout_.position_bits, grid.bits);
    }
    return {};
  }

  void round_levels() {
    for_each_in_parallel(meshes_.size() * range_.count, [&](std::size_t i) {
      const std::size_t mesh = i / range_.count;
      round_level(impl_.sources[mesh], grids_[mesh], geometry_[mesh][i % range_.count]);
    });
  }

  Result<void> encode_levels_side_by_side() {
    std::vector<LevelToEncode> levels;
    std::vector<EncodedLevel*> to;
    encoded_.assign(meshes_.size(), std::vector<EncodedLevel>(range_.count));
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh)
      for (std::size_t level = 0; level < range_.count; ++level) {
        if (repeats_coarser(mesh, level)) continue;
        levels.push_back({&impl_.sources[mesh], &geometry_[mesh][level], &grids_[mesh]});
        to.push_back(&encoded_[mesh][level]);
      }
    const Progress progress = options_.progress.part(kEncodingShare);
    std::vector<EncodedLevel> encoded = encode_levels(levels, options_, progress);
    if (!progress.reach(1)) return cancelled();
    for (std::size_t i = 0; i < to.size(); ++i) *to[i] = std::move(encoded[i]);
    return {};
  }

  /// The finest level keeps what it has: it shares no data that are mended.
  bool repeats_coarser(std::size_t mesh, std::size_t level) const {
    if (level + 1 == range_.count || (level == 0 && !geometry_[mesh][1].mended.empty())) return false;
    return same_mesh(level_of(mesh, level).mesh, level_of(mesh, level + 1).mesh);
  }

  Result<void> add_level(std::size_t level) {
    const std::uint64_t begin = padded_to_four(builder_.binary_bytes());
    AssetLayout::Level& layout = layout_.levels[level];
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
      WrittenLevel& written = written_[mesh][level];
      if (repeats_coarser(mesh, level)) {
        written = written_[mesh][level + 1];
      } else {
        const MeshSource& source = impl_.sources[mesh];
        LODESTONE_TRY(written, write_level(builder_, impl_.document.list("meshes")[source.mesh], source,
                                           geometry_[mesh][level], grids_[mesh], encoded_[mesh][level], options_));
        encoded_[mesh][level] = {};
        for (const std::string& note : written.notes) add_note(note);
      }
      if (!options_.progress.add((1 - kEncodingShare) / static_cast<double>(range_.count * meshes_.size())))
        return cancelled();
      layout.geometry_bytes += written.byte_count;
      collapsed_[level] += written.collapsed_face_count * scene_.meshes()[mesh].instance_count;
      layout.face_count += written.face_count * scene_.meshes()[mesh].instance_count;
      layout.vertex_count += written.vertex_count * scene_.meshes()[mesh].instance_count;
    }
    layout.byte_offset = begin;
    layout.byte_length = std::max(begin, builder_.binary_bytes()) - begin;
    return {};
  }

  /// Levels of one mesh mostly have the same to say.
  void add_note(const std::string& note) {
    std::vector<std::string>& notes = layout_.notes;
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  }

  void note_collapsed() {
    std::string counts;
    for (std::size_t level = 0; level < range_.count; ++level)
      if (collapsed_[level] > 0)
        counts += text(counts.empty() ? "" : ", ", collapsed_[level], " of ", layout_.levels[level].face_count,
                       " in level ", range_.first + level);
    if (counts.empty()) return;
    add_note(
        text("faces collapse on the grid, which moves vertices by up to ", layout_.quantisation_error, ": ", counts));
  }

  void list_levels() {
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
      levels_.emplace_back();
      for (std::size_t level = 0; level < range_.count; ++level) {
        const AssetLevel& given = level_of(mesh, level);
        levels_.back().push_back({std::move(written_[mesh][level].decoded), given.deviation, given.curvature_error,
                                  given.stop_reason, given.deviation_beyond});
      }
    }
  }

  /// The parts of an object change their level together, at the object's size on the screen.
  void choose_coverages() {
    if (range_.count == 1) return;
    for (const SceneObject& object : find_objects(impl_)) {
      std::vector<double> errors;
      for (std::size_t level = 0; level < range_.count; ++level)
        errors.push_back(visible_error(look_of(object, level)));
      const Vec3 sides = object.box.high - object.box.low;
      const std::vector<double> values = screen_coverages(std::max({sides.x, sides.y, sides.z}), errors);
      for (const ScenePart& part : object.parts) coverages_[impl_.sources[part.mesh].nodes[part.node]] = values;
    }
  }

  LevelLook look_of(const SceneObject& object, std::size_t level) const {
    LevelLook look;
    double squares = 0, angle = 0;
    for (const ScenePart& part : object.parts) {
      const NodePresence& presence = impl_.sources[part.mesh].presence[part.node];
      const Deviation& d = levels_[part.mesh][level].deviation;
      const double rms = presence.scale * std::max(d.forward.rms, d.backward.rms);
      squares += presence.area * rms * rms;
      angle += presence.area * d.mean_normal_angle;
      look.area += presence.area;
      look.face_count += static_cast<double>(written_[part.mesh][level].face_count * presence.instance_count);
    }
    if (!(look.area > 0)) return look;
    look.rms_deviation = std::sqrt(squares / look.area);
    look.normal_angle = angle / look.area;
    return look;
  }

  bool shows(std::size_t mesh, std::size_t level) const { return !written_[mesh][level].primitives.empty(); }

  /// The finest level takes the mesh's own place.
  void add_finest(std::size_t mesh) {
    Json primitives = shows(mesh, 0) ? written_[mesh][0].primitives : placeholder_primitives();
    Json& object = builder_.at("meshes", impl_.sources[mesh].mesh);  // only now: adding objects moves the others
    erase_extension(object, kStreamExtension);
    originals_.push_back(object);
    object["primitives"] = std::move(primitives);
  }

  /// Every node of a lower level has a mesh of its own, though their data are shared: clients that make instances of
  /// meshes lose them when they throw the level away whose mesh it was.
  std::size_t add_lower_mesh(std::size_t mesh, std::size_t level) {
    Json object = originals_[mesh];
    if (object.contains("name")) object["name"] = text(string_member(object, "name"), "_LOD", level);
    object["primitives"] = written_[mesh][level].primitives;
    materials_.separate(object["primitives"], level);
    const std::size_t added = builder_.add("meshes", std::move(object));
    lower_meshes_[mesh].push_back({added, written_[mesh][level].sources});
    return added;
  }

  /// glTF has no empty mesh, but the numbers of the others must stay: one triangle of no size, that nothing shows.
  Json placeholder_primitives() {
    const Json accessor = {
        {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}, {"min", {0, 0, 0}}, {"max", {0, 0, 0}}};
    return Json::array({Json{{"attributes", {{"POSITION", builder_.add("accessors", accessor)}}}}});
  }

  /// What one level is refined by comes later than all else, and by parts: not out of one buffer with it.
  bool streams_are_files() const { return !options_.gltf_name.empty() && range_.is_picked; }

  /// The stream refines to the finest level and so belongs to its mesh; a level without faces has neither.
  void add_stream(std::size_t mesh) {
    const std::vector<std::byte>& stream = meshes_[mesh].stream;
    if (stream.empty() || !shows(mesh, 0)) return;
    Json extension;
    if (streams_are_files() && is_compact(stream)) {
      const std::string path = text(options_.gltf_name, meshes_.size() > 1 ? text('_', mesh) : "", ".lods");
      extension["uri"] = uri_of(path);
      beside_.push_back({path, stream});
    } else {
      extension["bufferView"] = builder_.add_view(stream);
    }
    extension["version"] = version_text(stream);
    if (is_compact(stream) && range_.is_picked) add_shown_numbers(levels_[mesh][0], scene_.meshes()[mesh], extension);
    Json& extensions = builder_.at("meshes", impl_.sources[mesh].mesh)["extensions"];
    if (!extensions.is_object()) extensions = Json::object();
    extensions[kStreamExtension] = std::move(extension);
    builder_.use_extension(kStreamExtension);
    layout_.stream_bytes += stream.size();
  }

  /// Nodes of one level stay as they are, but for those whose mesh has nothing left to show.
  void add_nodes(std::size_t mesh, std::size_t node) {
    if (range_.count == 1) {
      Json unused;
      if (!shows(mesh, 0)) move_mesh_members(builder_.at("nodes", node), unused);
      return;
    }
    const std::string name = node_name(mesh, node);
    if (shows(mesh, 0) && stays_in_place(builder_.document(), node)) {
      Json& finest = builder_.at("nodes", node);
      set_finest_members(mesh, node, finest, builder_.document()["nodes"].size());
      add_lower_nodes(mesh, node, node, name);
    } else {
      const std::size_t first = add_finest_node(mesh, node, name);
      add_lower_nodes(mesh, node, first, name);
    }
    builder_.use_extension("MSFT_lod");
  }

  /// Moves what shows the mesh to a child of the node: the node's other members are of no single level.
  std::size_t add_finest_node(std::size_t mesh, std::size_t node, const std::string& name) {
    Json finest;
    finest["name"] = text(name, "_LOD0");
    move_mesh_members(builder_.at("nodes", node), finest);
    if (!shows(mesh, 0))
      for (const char* key : {"mesh", "skin", "weights"}) finest.erase(key);
    set_finest_members(mesh, node, finest, builder_.document()["nodes"].size() + 1);
    const std::size_t first = builder_.add("nodes", std::move(finest));
    builder_.at("nodes", node)["children"].push_back(first);
    return first;
  }

  /// `node` had the mesh in the document; `lower` will be the number of the node of level 1, the others follow it.
  void set_finest_members(std::size_t mesh, std::size_t node, Json& finest, std::size_t lower) {
    Json ids = Json::array();
    for (std::size_t level = 1; level < range_.count; ++level) ids.push_back(lower + level - 1);
    finest["extensions"]["MSFT_lod"] = {{"ids", std::move(ids)}};
    finest["extras"]["lodestone"] = numbers_of(mesh, 0);
    finest["extras"]["MSFT_screencoverage"] = coverages_.at(node);
  }

  /// Adds the coarser levels below `finest`; `node` had the mesh in the document.
  void add_lower_nodes(std::size_t mesh, std::size_t node, std::size_t finest, const std::string& name) {
    const Json members = builder_.at("nodes", finest);
    std::vector<std::size_t> shown{finest};
    for (std::size_t level = 1; level < range_.count; ++level) {
      const std::size_t added = add_lower_node(mesh, level, name, members);
      if (shows(mesh, level)) shown.push_back(added);
    }
    channels_.move_weights(node, shown);
  }

  std::size_t add_lower_node(std::size_t mesh, std::size_t level, const std::string& name, const Json& finest) {
    Json lower;
    lower["name"] = text(name, "_LOD", level);
    lower["extras"]["lodestone"] = numbers_of(mesh, level);
    if (shows(mesh, level)) {
      lower["mesh"] = add_lower_mesh(mesh, level);
      copy_instance_members(finest, lower);
    }
    return builder_.add("nodes", std::move(lower));
  }

  /// What animations moved in the document they move wherever it is now.
  void move_channels() {
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
      const std::size_t number = impl_.sources[mesh].mesh;
      std::vector<ChannelMap::Place> places{{number, written_[mesh][0].sources}};
      places.insert(places.end(), lower_meshes_[mesh].begin(), lower_meshes_[mesh].end());
      channels_.move_mesh(number, std::move(places));
    }
    materials_.describe(channels_);
    channels_.apply(builder_.document());
  }

  std::string node_name(std::size_t mesh, std::size_t node) {
    std::string name = string_member(builder_.at("nodes", node), "name");
    if (name.empty()) name = scene_.meshes()[mesh].name;
    return name.empty() ? "mesh" : name;
  }

  Json numbers_of(std::size_t mesh, std::size_t level) const {
    std::optional<double> position_step;
    if (options_.compression != Compression::None) position_step = grids_[mesh].position.step();
    return level_numbers(levels_[mesh][level], written_[mesh][level], scene_.meshes()[mesh],
                         impl_.sources[mesh].nodes.size(), position_step);
  }

  Scene scene_;
  const Scene::Impl& impl_;
  std::span<const LeveledMesh> meshes_;
  LevelRange range_;
  bool with_streams_;
  AssetOptions options_;
  BufferPlan plan_;
  GlbBuilder builder_;
  LevelMaterials materials_;
  ChannelMap channels_;
  std::vector<std::vector<ChannelMap::Place>> lower_meshes_;  // by mesh
  std::vector<std::vector<LevelGeometry>> geometry_;          // by mesh and level, as the next
  std::vector<std::vector<WrittenLevel>> written_;
  std::map<std::size_t, std::vector<double>> coverages_;  // by node of the document: MSFT_screencoverage
  std::vector<std::vector<AssetLevel>> levels_;           // with the numbers that the file states
  std::vector<Json> originals_;                           // the meshes as they were in the document
  std::vector<QuantizationGrids> grids_;
  std::vector<std::vector<EncodedLevel>> encoded_;  // until they are written
  std::vector<AssetFile> beside_;                   // images
  AssetLayout layout_;
  std::vector<std::uint64_t> collapsed_;  // faces of each level, all instances counted
};

}  // namespace

struct EncodedGeometry::Impl {
  Impl(const Scene& scene, std::span<const LeveledMesh> meshes, LevelRange range, bool with_streams,
       const AssetOptions& options)
      : writer(scene, meshes, range, with_streams, options) {}

  SceneWriter writer;
};

EncodedGeometry::EncodedGeometry(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EncodedGeometry::~EncodedGeometry() = default;
EncodedGeometry::EncodedGeometry(EncodedGeometry&&) noexcept = default;
EncodedGeometry& EncodedGeometry::operator=(EncodedGeometry&&) noexcept = default;

std::vector<std::vector<AssetLevel>>& EncodedGeometry::levels() { return impl_->writer.levels(); }

Result<EncodedGeometry> encode_geometry(const Scene& scene, std::span<const LeveledMesh> meshes,
                                        const AssetOptions& options, const FileContent& content) {
  LODESTONE_CHECK(check_options(options));
  LODESTONE_TRY(LevelRange range, all_levels(scene, meshes));
  if (content.level && *content.level >= range.count)
    return fail(ErrorCode::InvalidArgument, text("level ", *content.level, " of ", range.count, " does not exist"));
  if (content.level) range = {*content.level, 1, true};
  auto impl = std::make_unique<EncodedGeometry::Impl>(scene, meshes, range, content.streams, options);
  LODESTONE_CHECK(impl->writer.encode());
  return EncodedGeometry(std::move(impl));
}

Result<EncodedAsset> write_asset(EncodedGeometry geometry) { return geometry.impl().writer.write(); }

Result<EncodedAsset> encode_scene(const Scene& scene, std::span<const LeveledMesh> meshes,
                                  const AssetOptions& options) {
  LODESTONE_TRY(EncodedGeometry geometry, encode_geometry(scene, meshes, options));
  return write_asset(std::move(geometry));
}

Result<EncodedAsset> encode_scene_level(const Scene& scene, std::span<const LeveledMesh> meshes, std::size_t level,
                                        const AssetOptions& options) {
  LODESTONE_TRY(EncodedGeometry geometry, encode_geometry(scene, meshes, options, {level, false}));
  return write_asset(std::move(geometry));
}

}  // namespace lodestone

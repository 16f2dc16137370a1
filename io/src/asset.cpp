// A multi-LOD .glb: one node per level tied together by MSFT_lod, geometry plain or Draco, the removal stream last.

#include <lodestone/io/asset.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

#include "bytes.h"
#include "draco_decode.h"
#include "draco_encode.h"
#include "glb_builder.h"
#include "gltf_attribute.h"
#include "gltf_mesh_writer.h"
#include "stream_extension.h"
#include "text.h"
#include "try.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr int kMaxQuantizationBits = 30;  // Draco's limit
constexpr int kMinNormalBits = 2;

struct BitsOption {
  const char* name;
  int value;
  int least;
};

Result<void> check_options(const AssetOptions& options) {
  if (!options.draco) return {};
  for (const BitsOption& bits : {BitsOption{"draco_position_bits", options.draco_position_bits, 1},
                                 BitsOption{"draco_normal_bits", options.draco_normal_bits, kMinNormalBits},
                                 BitsOption{"draco_texcoord_bits", options.draco_texcoord_bits, 1},
                                 BitsOption{"draco_generic_bits", options.draco_generic_bits, 1}})
    if (bits.value < bits.least || bits.value > kMaxQuantizationBits)
      return fail(ErrorCode::InvalidArgument,
                  text(bits.name, " is ", bits.value, ", not in ", bits.least, " to ", kMaxQuantizationBits));
  if (options.draco_compression_level < 0 || options.draco_compression_level > 10)
    return fail(ErrorCode::InvalidArgument,
                text("draco_compression_level is ", options.draco_compression_level, ", not in 0 to 10"));
  return {};
}

/// Grows a box over values; components of one element lie next to each other.
class GridFitter {
 public:
  explicit GridFitter(std::size_t component_count)
      : low_(component_count, HUGE_VALF), high_(component_count, -HUGE_VALF) {}

  void add(std::span<const float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      low_[i % low_.size()] = std::min(low_[i % low_.size()], values[i]);
      high_[i % low_.size()] = std::max(high_[i % low_.size()], values[i]);
    }
  }

  QuantizationGrid grid(int bits) const {
    QuantizationGrid grid{low_, 0, bits};
    for (std::size_t i = 0; i < low_.size(); ++i) {
      if (low_[i] > high_[i])
        grid.origin[i] = 0;  // no values at all
      else
        grid.range = std::max(grid.range, high_[i] - low_[i]);
    }
    if (grid.range == 0) grid.range = 1;
    return grid;
  }

 private:
  std::vector<float> low_, high_;
};

std::span<const float> as_floats(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float)};
}

int bits_for(const std::string& name, const AssetOptions& options) {
  if (name == "POSITION") return options.draco_position_bits;
  if (name == "NORMAL") return options.draco_normal_bits;
  return name.starts_with("TEXCOORD_") ? options.draco_texcoord_bits : options.draco_generic_bits;
}

/// Fits one grid per attribute over all levels: levels of different grids would not fit together.
QuantizationGrids fit_grids(std::span<const AssetLevel> levels, const AssetOptions& options) {
  std::map<std::string, GridFitter> fitters;
  for (const AssetLevel& level : levels) {
    const Mesh& mesh = level.mesh;
    fitters.try_emplace("POSITION", 3).first->second.add(as_floats(std::as_bytes(std::span(mesh.positions))));
    for (const Attribute& a : mesh.attributes)
      if (a.type == ComponentType::Float32)
        fitters.try_emplace(a.name, a.component_count).first->second.add(as_floats(a.data));
  }
  QuantizationGrids grids;
  for (const auto& [name, fitter] : fitters) grids[name] = fitter.grid(bits_for(name, options));
  return grids;
}

/// A level's mesh in the document, and what a client will get out of it.
struct WrittenMesh {
  std::optional<std::size_t> index;  ///< nothing for a level without faces
  std::uint64_t face_count = 0;
  std::uint64_t vertex_count = 0;
};

Json attribute_accessor(const AccessorData& data) {
  Json accessor = {
      {"componentType", static_cast<int>(data.type)}, {"count", data.count}, {"type", gltf_type(data.component_count)}};
  if (data.normalized && data.type != ComponentType::Float32) accessor["normalized"] = true;
  return accessor;
}

Json position_accessor(const AccessorData& data) {
  std::vector<Vec3f> positions(data.count);
  std::memcpy(static_cast<void*>(positions.data()), data.bytes.data(), data.bytes.size());
  Json accessor = attribute_accessor(data);
  auto [low, high] = position_bounds(positions);
  accessor["min"] = std::move(low);
  accessor["max"] = std::move(high);
  return accessor;
}

/// Writes one primitive. Its accessors describe what the encoded bytes decode to, which Draco decides: it may split
/// points, and it moves them.
Result<Json> add_draco_primitive(GlbBuilder& builder, const Mesh& mesh, const FacesOfMaterial& group,
                                 const QuantizationGrids& grids, const AssetOptions& options, WrittenMesh& written) {
  LODESTONE_TRY(const DracoPrimitive encoded,
                encode_draco(mesh, group.corner_wedge, grids, options.draco_compression_level));
  std::vector<DracoRequest> requests{{encoded.position_id, ComponentType::Float32, 3, false}};
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    const Attribute& a = mesh.attributes[i];
    requests.push_back({encoded.attribute_ids[i], a.type, a.component_count, a.normalized});
  }
  LODESTONE_TRY(const DracoGeometry decoded, decode_draco(encoded.bytes, requests, "encoded level"));
  written.face_count += decoded.indices.size() / 3;
  written.vertex_count += decoded.point_count;

  Json attributes = {{"POSITION", builder.add("accessors", position_accessor(decoded.attributes[0]))}};
  Json ids = {{"POSITION", encoded.position_id}};
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    const auto semantic = gltf_semantic(mesh.attributes[i]);
    if (!semantic) continue;
    if (semantic->needs_quantization) builder.require_extension("KHR_mesh_quantization");
    attributes[semantic->name] = builder.add("accessors", attribute_accessor(decoded.attributes[i + 1]));
    ids[semantic->name] = encoded.attribute_ids[i];
  }
  const auto index_type = decoded.point_count <= 0xffff ? ComponentType::UInt16 : ComponentType::UInt32;
  const AccessorData indices{index_type, 1, false, decoded.indices.size(), {}};
  return Json{{"attributes", std::move(attributes)},
              {"indices", builder.add("accessors", attribute_accessor(indices))},
              {"extensions",
               {{"KHR_draco_mesh_compression",
                 {{"bufferView", builder.add_view(encoded.bytes)}, {"attributes", std::move(ids)}}}}}};
}

Result<WrittenMesh> add_draco_mesh(GlbBuilder& builder, const Mesh& mesh, const std::string& name,
                                   const QuantizationGrids& grids, const AssetOptions& options,
                                   const MaterialTable& materials) {
  WrittenMesh written;
  if (mesh.face_count() == 0) return written;
  builder.require_extension("KHR_draco_mesh_compression");
  Json primitives = Json::array();
  for (const FacesOfMaterial& group : split_by_material(mesh)) {
    LODESTONE_TRY(Json primitive, add_draco_primitive(builder, mesh, group, grids, options, written));
    materials.assign(primitive, group.material);
    primitives.push_back(std::move(primitive));
  }
  written.index = builder.add("meshes", {{"name", name}, {"primitives", std::move(primitives)}});
  return written;
}

WrittenMesh add_uncompressed_mesh(GlbBuilder& builder, const Mesh& mesh, const std::string& name,
                                  const MaterialTable& materials) {
  const Mesh ordered = in_hardware_order(mesh);
  return {add_plain_mesh(builder, ordered, name, materials), ordered.face_count(), ordered.wedge_count()};
}

/// Sets a number unless it is infinite or NaN, which JSON cannot say.
void set_finite(Json& object, const char* key, double value) {
  if (std::isfinite(value)) object[key] = value;
}

Json level_numbers(const AssetLevel& level, const WrittenMesh& written, std::optional<double> position_step) {
  const Deviation& d = level.deviation;
  Json numbers = {{"faces", written.face_count}, {"vertices", written.vertex_count}};
  set_finite(numbers, "maximum_deviation", d.maximum());
  set_finite(numbers, "mean_deviation", std::max(d.forward.mean, d.backward.mean));
  set_finite(numbers, "rms_deviation", std::max(d.forward.rms, d.backward.rms));
  set_finite(numbers, "curvature_error", level.curvature_error);
  if (position_step) set_finite(numbers, "position_step", *position_step);
  numbers["stop_reason"] = level.stop_reason;
  return numbers;
}

/// Returns MSFT_screencoverage: the share of the screen's area below which the next level is good enough.
///
/// The next level, of deviation d, is good enough while d projects to at most one pixel of a screen of 1920 × 1080. A
/// sphere as wide as the mesh's diagonal D then spans at most D/d pixels and covers π/4·(D/d)² of 1920·1080. Values
/// fall from level to level; the last is 0, so that nothing ever vanishes.
Json screen_coverage(std::span<const AssetLevel> levels) {
  constexpr double kPixels = 1920.0 * 1080.0;
  const double diagonal = bounding_box(levels[0].mesh).diagonal();
  Json coverage = Json::array();
  double last = 1;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    const double pixels = diagonal / levels[i].deviation.maximum();  // of the whole mesh, when d is one pixel
    const double share = std::numbers::pi / 4 * pixels * pixels / kPixels;
    last = std::isnan(share) ? last : std::min(last, share);
    coverage.push_back(last);
  }
  coverage.push_back(0);
  return coverage;
}

std::set<Index> material_numbers(std::span<const AssetLevel> levels) {
  std::set<Index> numbers;
  for (const AssetLevel& level : levels)
    numbers.insert(level.mesh.face_material.begin(), level.mesh.face_material.end());
  return numbers;
}

class AssetWriter {
 public:
  AssetWriter(std::span<const AssetLevel> levels, std::span<const std::byte> stream, const AssetOptions& options)
      : levels_(levels),
        stream_(stream),
        options_(options),
        materials_(builder_, material_numbers(levels)),
        written_(levels.size()) {}

  Result<EncodedAsset> write() {
    layout_.levels.resize(levels_.size());
    if (options_.draco) grids_ = fit_grids(levels_, options_);
    for (std::size_t i = levels_.size(); i-- > 0;) LODESTONE_CHECK(add_level(i));
    add_stream();
    add_nodes();
    LODESTONE_TRY(std::vector<std::byte> glb, builder_.finish());
    layout_.total_bytes = glb.size();
    return EncodedAsset{std::move(glb), std::move(layout_)};
  }

 private:
  std::string level_name(std::size_t level) const {
    return text(options_.name.empty() ? "mesh" : options_.name, "_LOD", level);
  }

  Result<void> add_level(std::size_t i) {
    const Mesh& mesh = levels_[i].mesh;
    const std::uint64_t begin = (builder_.binary_bytes() + 3) / 4 * 4;
    if (options_.draco) {
      LODESTONE_TRY(written_[i], add_draco_mesh(builder_, mesh, level_name(i), grids_, options_, materials_));
    } else {
      written_[i] = add_uncompressed_mesh(builder_, mesh, level_name(i), materials_);
    }
    const std::uint64_t end = std::max(begin, builder_.binary_bytes());
    layout_.levels[i] = {begin, end - begin, written_[i].face_count, written_[i].vertex_count};
    return {};
  }

  /// The stream refines to the finest level and so belongs to its mesh; a level without faces has neither.
  void add_stream() {
    if (stream_.empty() || !written_[0].index) return;
    const std::size_t view = builder_.add_view(stream_);
    builder_.at("meshes", *written_[0].index)["extensions"] = {
        {kStreamExtension, {{"bufferView", view}, {"version", kStreamExtensionVersion}}}};
    builder_.use_extension(kStreamExtension);
    layout_.stream_bytes = stream_.size();
  }

  void add_nodes() {
    Json root;
    if (!options_.name.empty()) root["name"] = options_.name;
    root["children"] = Json::array({1});
    builder_.add("nodes", std::move(root));
    Json lower = Json::array();
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const std::size_t node = builder_.add("nodes", level_node(i));
      if (i > 0) lower.push_back(node);
    }
    if (!lower.empty()) {
      Json& finest = builder_.at("nodes", 1);
      finest["extensions"] = {{"MSFT_lod", {{"ids", std::move(lower)}}}};
      finest["extras"]["MSFT_screencoverage"] = screen_coverage(levels_);
      builder_.use_extension("MSFT_lod");
    }
    builder_.add("scenes", {{"nodes", Json::array({0})}});
  }

  Json level_node(std::size_t i) const {
    std::optional<double> position_step;
    if (options_.draco) position_step = grids_.at("POSITION").step();
    Json node;
    node["name"] = level_name(i);
    if (written_[i].index) node["mesh"] = *written_[i].index;
    node["extras"]["lodestone"] = level_numbers(levels_[i], written_[i], position_step);
    return node;
  }

  std::span<const AssetLevel> levels_;
  std::span<const std::byte> stream_;
  const AssetOptions& options_;
  GlbBuilder builder_;
  MaterialTable materials_;
  QuantizationGrids grids_;
  std::vector<WrittenMesh> written_;
  AssetLayout layout_;
};

}  // namespace

Result<EncodedAsset> encode_asset(std::span<const AssetLevel> levels, std::span<const std::byte> stream,
                                  const AssetOptions& options) {
  LODESTONE_CHECK(check_options(options));
  if (levels.empty()) return fail(ErrorCode::InvalidArgument, "an asset needs at least one level");
  return AssetWriter(levels, stream, options).write();
}

}  // namespace lodestone

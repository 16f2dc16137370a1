#include "scene/scene_primitives.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "gltf/gltf_attribute.h"
#include "gltf/gltf_mesh_writer.h"
#include "scene/meshopt_accessors.h"
#include "scene/scene_buffers.h"
#include "scene/scene_mesh.h"

namespace lodestone::detail {
namespace {

/// What replaces the geometry of one primitive.
struct PrimitiveGeometry {
  Json attributes = Json::object();
  std::size_t indices = 0;
  Json targets;  ///< null for none
  Json draco;    ///< the extension's object; null for none
};

/// What a client gets out of Draco data, every point a vertex: positions and faces, no attributes.
Mesh decoded_surface(const DracoGeometry& decoded) {
  Mesh mesh;
  mesh.positions.resize(decoded.point_count);
  std::memcpy(mesh.positions.data(), decoded.attributes[0].bytes.data(), decoded.attributes[0].bytes.size());
  mesh.wedge_vertex.resize(decoded.point_count);
  std::iota(mesh.wedge_vertex.begin(), mesh.wedge_vertex.end(), Index{0});
  mesh.corner_wedge = decoded.indices;
  return mesh;
}

/// Counts the faces with two corners at one place.
std::uint64_t count_collapsed(const Mesh& mesh) {
  std::uint64_t count = 0;
  for (Index corner = 0; corner < mesh.corner_wedge.size(); corner += 3) {
    const Vec3f& a = mesh.positions[mesh.corner_vertex(corner)];
    const Vec3f& b = mesh.positions[mesh.corner_vertex(corner + 1)];
    const Vec3f& c = mesh.positions[mesh.corner_vertex(corner + 2)];
    count += a == b || b == c || c == a;
  }
  return count;
}

/// Joins what is equal, as readers do. Faces that have lost their area go, unless there are no others: something so
/// small still is somewhere.
Result<Mesh> joined(const TriangleSoup& soup) {
  LODESTONE_TRY(AssembledMesh assembled, assemble(soup));
  if (assembled.mesh.face_count() > 0) return std::move(assembled.mesh);
  Mesh mesh{soup.positions, std::vector<Index>(soup.positions.size()), soup.indices, soup.face_material,
            soup.attributes};
  std::iota(mesh.wedge_vertex.begin(), mesh.wedge_vertex.end(), Index{0});
  return mesh;
}

/// Adds the accessors of a level's primitives, one primitive or one level at a time.
class GeometryWriter {
 public:
  GeometryWriter(GlbBuilder& builder, const MeshSource& source, const LevelGeometry& level,
                 const QuantizationGrids& grids, const AssetOptions& options, WrittenLevel& written)
      : builder_(builder), source_(source), level_(level), grids_(grids), options_(options), written_(written) {}

  std::map<Index, PrimitiveGeometry> write(const EncodedLevel& encoded) {
    std::map<Index, PrimitiveGeometry> geometry;
    if (packs()) written_.collapsed_face_count = count_collapsed(*level_.mesh);
    if (!uses_draco() && share_vertices(encoded.groups)) return write_shared();
    for (std::size_t i = 0; i < encoded.groups.size(); ++i) {
      const FacesOfMaterial& group = encoded.groups[i];
      const SourcePrimitive& primitive = source_.primitives[group.material];
      geometry[group.material] =
          uses_draco() ? write_draco(primitive, group, encoded.outputs[i]) : write_plain(primitive, group);
    }
    return geometry;
  }

  /// Returns what clients get of the level. Pre: it is written, with `measure` set.
  Result<Mesh> decoded() {
    if (packs()) return joined(to_soup(with_attributes(*level_.mesh, level_.columns)));
    if (!uses_draco()) return with_attributes(*level_.mesh, level_.columns);
    complete_attributes(source_, decoded_);
    return joined(decoded_);
  }

 private:
  bool uses_draco() const { return options_.compression == Compression::Draco; }
  bool packs() const { return options_.compression == Compression::Meshopt; }
  FaceOrder order() const { return packs() ? FaceOrder::Packing : FaceOrder::Drawing; }

  bool share_vertices(std::span<const FacesOfMaterial> groups) const {
    return std::all_of(groups.begin(), groups.end(), [&](const FacesOfMaterial& group) {
      const SourcePrimitive& first = source_.primitives[groups[0].material];
      const SourcePrimitive& other = source_.primitives[group.material];
      return other.columns == first.columns && other.target_count == first.target_count;
    });
  }

  std::map<Index, PrimitiveGeometry> write_shared() {
    std::map<Index, PrimitiveGeometry> geometry;
    if (level_.mesh->face_count() == 0) return geometry;
    const SourcePrimitive& primitive = source_.primitives[level_.mesh->material_of(0)];
    const Mesh ordered = in_hardware_order(with_attributes(*level_.mesh, attributes_of(level_, primitive)), order());
    count(ordered.face_count(), ordered.wedge_count());
    const PrimitiveGeometry shared = write_vertices(primitive, ordered);
    for (const FacesOfMaterial& group : split_by_material(ordered)) {
      geometry[group.material] = shared;
      geometry[group.material].indices = store_indices(group.corner_wedge, ordered.wedge_count());
    }
    return geometry;
  }

  PrimitiveGeometry write_plain(const SourcePrimitive& primitive, const FacesOfMaterial& group) {
    const Mesh mesh =
        in_hardware_order(submesh(*level_.mesh, group.corner_wedge, attributes_of(level_, primitive)), order());
    count(mesh.face_count(), mesh.wedge_count());
    PrimitiveGeometry geometry = write_vertices(primitive, mesh);
    geometry.indices = store_indices(mesh.corner_wedge, mesh.wedge_count());
    if (options_.keep_decoded && uses_draco()) note_decoded(primitive, group.material, mesh);
    return geometry;
  }

  /// Writes all but the indices. Pre: the mesh has the primitive's columns, in their order.
  PrimitiveGeometry write_vertices(const SourcePrimitive& primitive, const Mesh& mesh) {
    PrimitiveGeometry geometry;
    geometry.attributes["POSITION"] =
        packs() ? add_packed_positions(builder_, mesh, grids_.position) : add_positions(builder_, mesh);
    for (std::size_t i = 0; i < primitive.columns.size(); ++i) {
      const MeshColumn& column = source_.columns[primitive.columns[i]];
      if (column.target) continue;
      if (column.needs_quantization) builder_.require_extension("KHR_mesh_quantization");
      geometry.attributes[column.semantic] = store_attribute(primitive.columns[i], mesh.attributes[i]);
    }
    geometry.targets = write_targets(primitive, mesh);
    return geometry;
  }

  std::size_t store_attribute(std::size_t column, const Attribute& attribute) {
    return packs() ? add_packed_attribute(builder_, attribute, grids_.attributes[column])
                   : add_attribute(builder_, attribute);
  }

  std::size_t store_indices(std::span<const Index> indices, std::size_t point_count) {
    return packs() ? add_packed_indices(builder_, indices, point_count) : add_indices(builder_, indices, point_count);
  }

  /// Morph targets are plain accessors, with Draco too.
  Json write_targets(const SourcePrimitive& primitive, const Mesh& mesh) {
    if (primitive.target_count == 0) return nullptr;
    Json targets = Json::array();
    targets.get_ref<Json::array_t&>().resize(primitive.target_count, Json::object());
    for (std::size_t i = 0; i < primitive.columns.size(); ++i) {
      const MeshColumn& column = source_.columns[primitive.columns[i]];
      if (!column.target) continue;
      const std::size_t accessor = store_attribute(primitive.columns[i], mesh.attributes[i]);
      if (column.semantic == "POSITION") set_bounds(builder_.at("accessors", accessor), mesh.attributes[i].data);
      targets[*column.target][column.semantic] = accessor;
    }
    return targets;
  }

  /// Accessors describe what the encoded bytes decode to, which Draco decides: it may split points, and it moves them.
  PrimitiveGeometry write_draco(const SourcePrimitive& primitive, const FacesOfMaterial& group,
                                const Result<DracoOutput>& output) {
    if (!output) return write_uncompressed(primitive, group, output.error().message);
    Mesh mesh;  // of which targets alone are not in Draco data
    if (primitive.target_count > 0) mesh = submesh(*level_.mesh, group.corner_wedge, attributes_of(level_, primitive));
    PrimitiveGeometry geometry = describe_draco(primitive, output->encoded, output->decoded);
    geometry.targets = write_targets(primitive, mesh);
    if (options_.keep_decoded) note_decoded(primitive, group.material, decoded_mesh(primitive, output->decoded, mesh));
    return geometry;
  }

  PrimitiveGeometry write_uncompressed(const SourcePrimitive& primitive, const FacesOfMaterial& group,
                                       const std::string& reason) {
    written_.notes.push_back(
        text("mesh ", source_.mesh, " primitive ", group.material, " is stored without Draco: ", reason));
    return write_plain(primitive, group);
  }

  /// Returns what a client gets of a primitive: targets as they were in `encoded`, the rest out of Draco data.
  Mesh decoded_mesh(const SourcePrimitive& primitive, const DracoGeometry& decoded, const Mesh& encoded) const {
    Mesh mesh = decoded_surface(decoded);
    std::size_t next = 0;
    for (std::size_t i = 0; i < primitive.columns.size(); ++i) {
      const std::size_t column = primitive.columns[i];
      const Attribute& a = *level_.columns[column];
      const bool is_target = source_.columns[column].target.has_value();
      mesh.attributes.push_back({a.name, a.type, a.component_count, a.normalized,
                                 is_target ? encoded.attributes[i].data : decoded.attributes[++next].bytes});
    }
    return mesh;
  }

  PrimitiveGeometry describe_draco(const SourcePrimitive& primitive, const DracoPrimitive& encoded,
                                   const DracoGeometry& decoded) {
    builder_.require_extension(kDraco);
    count(decoded.indices.size() / 3, decoded.point_count);
    written_.collapsed_face_count += count_collapsed(decoded_surface(decoded));
    PrimitiveGeometry geometry;
    geometry.attributes["POSITION"] = builder_.add("accessors", position_accessor(decoded.attributes[0]));
    Json ids = {{"POSITION", encoded.position_id}};
    std::size_t next = 0;
    for (const std::size_t number : primitive.columns) {
      const MeshColumn& column = source_.columns[number];
      if (column.target) continue;
      if (column.needs_quantization) builder_.require_extension("KHR_mesh_quantization");
      ids[column.semantic] = encoded.attribute_ids[next];
      geometry.attributes[column.semantic] = builder_.add("accessors", attribute_accessor(decoded.attributes[++next]));
    }
    geometry.indices = builder_.add(
        "accessors", attribute_accessor({index_type(decoded.point_count), 1, false, decoded.indices.size(), {}}));
    geometry.draco = {{"bufferView", builder_.add_view(encoded.bytes)}, {"attributes", std::move(ids)}};
    return geometry;
  }

  /// Notes what a client gets of a primitive. Pre: the mesh has the primitive's columns, in their order.
  void note_decoded(const SourcePrimitive& primitive, Index material, const Mesh& mesh) {
    const std::size_t first = decoded_.positions.size();
    for (const Index vertex : mesh.wedge_vertex) decoded_.positions.push_back(mesh.positions[vertex]);
    for (const Index wedge : mesh.corner_wedge) decoded_.indices.push_back(static_cast<Index>(first + wedge));
    decoded_.face_material.insert(decoded_.face_material.end(), mesh.face_count(), material);
    decoded_.attributes.resize(source_.columns.size());
    for (std::size_t i = 0; i < primitive.columns.size(); ++i) {
      std::vector<std::byte>& data = decoded_.attributes[primitive.columns[i]].data;
      data.resize(first * mesh.attributes[i].element_bytes());
      append_bytes(data, mesh.attributes[i].data);
    }
  }

  void count(std::size_t faces, std::size_t vertices) {
    written_.face_count += faces;
    written_.vertex_count += vertices;
  }

  GlbBuilder& builder_;
  const MeshSource& source_;
  const LevelGeometry& level_;
  const QuantizationGrids& grids_;
  const AssetOptions& options_;
  WrittenLevel& written_;
  TriangleSoup decoded_;  // only with options_.keep_decoded and Draco
};

/// Keeps all of a primitive but its geometry.
Json replace_geometry(const Json& source, const PrimitiveGeometry& geometry) {
  Json primitive = source;
  for (const char* key : {"mode", "targets"}) primitive.erase(key);
  erase_extension(primitive, kDraco);
  primitive["attributes"] = geometry.attributes;
  primitive["indices"] = geometry.indices;
  if (!geometry.targets.is_null()) primitive["targets"] = geometry.targets;
  if (geometry.draco.is_null()) return primitive;
  if (!primitive.contains("extensions") || !primitive["extensions"].is_object())
    primitive["extensions"] = Json::object();
  primitive["extensions"][kDraco] = geometry.draco;
  return primitive;
}

bool has_type_of(const Attribute& a, const Attribute& b) {
  return a.type == b.type && (a.type == ComponentType::Float32 || a.normalized == b.normalized);
}

/// Whether normalized integers of a column can hold the attribute.
bool fits_after_rounding(const Attribute& a, const Attribute& b) {
  return a.type == ComponentType::Float32 && b.normalized && b.type != ComponentType::Float32;
}

bool belongs_to(const Attribute& a, const MeshColumn& column) {
  const Attribute& b = column.layout;
  if (a.component_count != b.component_count) return false;
  if (a.name == b.name) return true;
  // A level out of a stream has the name from before the file was written.
  const auto semantic = gltf_semantic(a);
  return !column.target && semantic && semantic->name == column.semantic;
}

/// Floats as normalized integers.
Attribute as_stored(const Attribute& floats, const Attribute& layout) {
  Attribute out = layout;
  const std::vector<float> values = attribute_values(floats);
  const std::size_t size = component_bytes(layout.type);
  out.data.resize(values.size() * size);
  for (std::size_t i = 0; i < values.size(); ++i)
    store_component(layout.type, true, static_cast<double>(values[i]), out.data.data() + i * size);
  return out;
}

}  // namespace

void LevelGeometry::replace_column(std::size_t column, Attribute attribute) {
  changed.push_back(std::make_unique<Attribute>(std::move(attribute)));
  columns[column] = changed.back().get();
}

void LevelGeometry::replace_mesh(std::unique_ptr<Mesh> other) {
  own_mesh = std::move(other);
  mesh = own_mesh.get();
}

Result<LevelGeometry> match_level(const Mesh& mesh, const MeshSource& source) {
  LevelGeometry level;
  level.mesh = &mesh;
  for (const MeshColumn& column : source.columns) {
    const auto find = [&](auto&& fits) {
      const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [&](const Attribute& a) {
        return fits(a, column.layout) && belongs_to(a, column);
      });
      return found == mesh.attributes.end() ? nullptr : &*found;
    };
    level.columns.push_back(find(has_type_of));
    if (level.columns.back() != nullptr) continue;
    const Attribute* const floats = find(fits_after_rounding);
    if (floats == nullptr)
      return fail(ErrorCode::InvalidArgument,
                  text("mesh ", source.mesh, ": a level lacks the attribute ", column.layout.name));
    level.replace_column(level.columns.size() - 1, as_stored(*floats, column.layout));
  }
  for (Index face = 0; face < mesh.face_count(); ++face)
    if (mesh.material_of(face) >= source.primitives.size() || !source.primitives[mesh.material_of(face)].replaced)
      return fail(ErrorCode::InvalidArgument, text("mesh ", source.mesh, ": a level has faces of primitive ",
                                                   mesh.material_of(face), ", which is none of triangles"));
  return level;
}

std::vector<const Attribute*> attributes_of(const LevelGeometry& level, const SourcePrimitive& primitive) {
  std::vector<const Attribute*> attributes;
  for (const std::size_t column : primitive.columns) attributes.push_back(level.columns[column]);
  return attributes;
}

Result<WrittenLevel> write_level(GlbBuilder& builder, const Json& source_mesh, const MeshSource& source,
                                 const LevelGeometry& level, const QuantizationGrids& grids,
                                 const EncodedLevel& encoded, const AssetOptions& options) {
  WrittenLevel written;
  const std::uint64_t begin = padded_to_four(builder.binary_bytes());
  GeometryWriter writer(builder, source, level, grids, options, written);
  const std::map<Index, PrimitiveGeometry> geometry = writer.write(encoded);
  if (options.keep_decoded) {
    LODESTONE_TRY(written.decoded, writer.decoded());
  }
  written.byte_count = std::max(begin, builder.binary_bytes()) - begin;
  const Json& primitives = source_mesh.at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const auto replacement = geometry.find(static_cast<Index>(i));
    if (source.primitives[i].replaced && replacement == geometry.end()) continue;
    written.primitives.push_back(source.primitives[i].replaced ? replace_geometry(primitives[i], replacement->second)
                                                               : primitives[i]);
    written.sources.push_back(i);
  }
  return written;
}

}  // namespace lodestone::detail

#include "draco_encode.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <exception>

#include "text.h"

namespace lodestone::detail {
namespace {

/// Numbers the things that faces use, in order of first use.
class Compaction {
 public:
  explicit Compaction(std::size_t count) : number_(count, kNoIndex) {}
  Index add(Index thing) {
    if (number_[thing] == kNoIndex) {
      number_[thing] = static_cast<Index>(used_.size());
      used_.push_back(thing);
    }
    return number_[thing];
  }
  std::span<const Index> used() const { return used_; }

 private:
  std::vector<Index> number_;
  std::vector<Index> used_;
};

draco::DataType draco_type(ComponentType type) {
  switch (type) {
    case ComponentType::Int8:
      return draco::DT_INT8;
    case ComponentType::UInt8:
      return draco::DT_UINT8;
    case ComponentType::Int16:
      return draco::DT_INT16;
    case ComponentType::UInt16:
      return draco::DT_UINT16;
    case ComponentType::UInt32:
      return draco::DT_UINT32;
    case ComponentType::Float32:
      return draco::DT_FLOAT32;
  }
  return draco::DT_INVALID;
}

draco::GeometryAttribute::Type draco_semantic(const Attribute& attribute) {
  if (attribute.name == "NORMAL" && attribute.type == ComponentType::Float32) return draco::GeometryAttribute::NORMAL;
  if (attribute.name.starts_with("TEXCOORD_")) return draco::GeometryAttribute::TEX_COORD;
  if (attribute.name.starts_with("COLOR_")) return draco::GeometryAttribute::COLOR;
  return draco::GeometryAttribute::GENERIC;
}

/// Builds Draco's form of the faces: a point for each wedge, a position value for each vertex, so that Draco sees the
/// surface as joined where only attributes differ.
class MeshBuilder {
 public:
  MeshBuilder(const Mesh& mesh, std::span<const Index> corner_wedge)
      : mesh_(mesh), wedges_(mesh.wedge_count()), vertices_(mesh.vertex_count()) {
    draco_.SetNumFaces(corner_wedge.size() / 3);
    for (std::size_t f = 0; f < corner_wedge.size() / 3; ++f) {
      draco::Mesh::Face face;
      for (int k = 0; k < 3; ++k) face[k] = draco::PointIndex(wedges_.add(corner_wedge[3 * f + k]));
      draco_.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(f)), face);
    }
    draco_.set_num_points(static_cast<std::uint32_t>(wedges_.used().size()));
    add_positions();
    for (const Attribute& attribute : mesh.attributes) attribute_ids_.push_back(add_attribute(attribute));
  }

  const draco::Mesh& mesh() const { return draco_; }
  int position_id() const { return position_id_; }
  const std::vector<int>& attribute_ids() const { return attribute_ids_; }

 private:
  void add_positions() {
    for (const Index wedge : wedges_.used()) vertices_.add(mesh_.wedge_vertex[wedge]);
    draco::GeometryAttribute layout;
    layout.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, sizeof(Vec3f), 0);
    position_id_ = draco_.AddAttribute(layout, false, static_cast<std::uint32_t>(vertices_.used().size()));
    draco::PointAttribute& positions = *draco_.attribute(position_id_);
    for (Index i = 0; i < vertices_.used().size(); ++i)
      positions.SetAttributeValue(draco::AttributeValueIndex(i), &mesh_.positions[vertices_.used()[i]]);
    for (Index i = 0; i < wedges_.used().size(); ++i)
      positions.SetPointMapEntry(draco::PointIndex(i),
                                 draco::AttributeValueIndex(vertices_.add(mesh_.wedge_vertex[wedges_.used()[i]])));
  }

  int add_attribute(const Attribute& attribute) {
    const std::size_t size = attribute.element_bytes();
    draco::GeometryAttribute layout;
    layout.Init(draco_semantic(attribute), nullptr, attribute.component_count, draco_type(attribute.type),
                attribute.normalized, static_cast<std::int64_t>(size), 0);
    const int id = draco_.AddAttribute(layout, true, static_cast<std::uint32_t>(wedges_.used().size()));
    for (Index i = 0; i < wedges_.used().size(); ++i)
      draco_.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                              attribute.data.data() + wedges_.used()[i] * size);
    return id;
  }

  const Mesh& mesh_;
  Compaction wedges_, vertices_;
  draco::Mesh draco_;
  int position_id_ = 0;
  std::vector<int> attribute_ids_;
};

void set_grid(draco::ExpertEncoder& encoder, int id, const QuantizationGrid& grid) {
  encoder.SetAttributeExplicitQuantization(id, grid.bits, static_cast<int>(grid.origin.size()), grid.origin.data(),
                                           grid.range);
}

}  // namespace

Result<DracoPrimitive> encode_draco(const Mesh& mesh, std::span<const Index> corner_wedge,
                                    const QuantizationGrids& grids, int compression_level) {
  try {
    const MeshBuilder builder(mesh, corner_wedge);
    draco::ExpertEncoder encoder(builder.mesh());
    encoder.SetSpeedOptions(10 - compression_level, 10 - compression_level);
    set_grid(encoder, builder.position_id(), grids.at("POSITION"));
    for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
      if (mesh.attributes[i].type != ComponentType::Float32) continue;
      const QuantizationGrid& grid = grids.at(mesh.attributes[i].name);
      if (mesh.attributes[i].name == "NORMAL")
        encoder.SetAttributeQuantization(builder.attribute_ids()[i], grid.bits);
      else
        set_grid(encoder, builder.attribute_ids()[i], grid);
    }
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeToBuffer(&buffer);
    if (!status.ok()) return fail(ErrorCode::InvalidArgument, text("Draco: ", status.error_msg_string()));

    DracoPrimitive primitive;
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    primitive.bytes.assign(bytes.begin(), bytes.end());
    primitive.position_id = builder.mesh().attribute(builder.position_id())->unique_id();
    for (const int id : builder.attribute_ids())
      primitive.attribute_ids.push_back(builder.mesh().attribute(id)->unique_id());
    return primitive;
  } catch (const std::exception& error) {
    return fail(ErrorCode::InvalidArgument, text("Draco: ", error.what()));
  }
}

}  // namespace lodestone::detail

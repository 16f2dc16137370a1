#include "draco_encode.h"

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <cmath>
#include <exception>
#include <limits>

#include "bytes.h"
#include "text.h"

namespace lodestone::detail {
namespace {

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
  explicit MeshBuilder(const Mesh& mesh) : mesh_(mesh) {
    draco_.SetNumFaces(mesh.face_count());
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      draco::Mesh::Face face;
      for (int k = 0; k < 3; ++k) face[k] = draco::PointIndex(mesh.corner_wedge[3 * f + static_cast<std::size_t>(k)]);
      draco_.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(f)), face);
    }
    draco_.set_num_points(static_cast<std::uint32_t>(mesh.wedge_count()));
    add_positions();
    for (const Attribute& attribute : mesh.attributes) attribute_ids_.push_back(add_attribute(attribute));
  }

  const draco::Mesh& mesh() const { return draco_; }
  int position_id() const { return position_id_; }
  const std::vector<int>& attribute_ids() const { return attribute_ids_; }

 private:
  void add_positions() {
    draco::GeometryAttribute layout;
    layout.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, sizeof(Vec3f), 0);
    position_id_ = draco_.AddAttribute(layout, false, static_cast<std::uint32_t>(mesh_.vertex_count()));
    draco::PointAttribute& positions = *draco_.attribute(position_id_);
    for (Index i = 0; i < mesh_.vertex_count(); ++i)
      positions.SetAttributeValue(draco::AttributeValueIndex(i), &mesh_.positions[i]);
    for (Index i = 0; i < mesh_.wedge_count(); ++i)
      positions.SetPointMapEntry(draco::PointIndex(i), draco::AttributeValueIndex(mesh_.wedge_vertex[i]));
  }

  int add_attribute(const Attribute& attribute) {
    const std::size_t size = attribute.element_bytes();
    draco::GeometryAttribute layout;
    layout.Init(draco_semantic(attribute), nullptr, attribute.component_count, draco_type(attribute.type),
                attribute.normalized, static_cast<std::int64_t>(size), 0);
    const int id = draco_.AddAttribute(layout, true, static_cast<std::uint32_t>(mesh_.wedge_count()));
    for (Index i = 0; i < mesh_.wedge_count(); ++i)
      draco_.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), attribute.data.data() + i * size);
    return id;
  }

  const Mesh& mesh_;
  draco::Mesh draco_;
  int position_id_ = 0;
  std::vector<int> attribute_ids_;
};

/// Says how every float attribute is quantised.
void set_grids(draco::ExpertEncoder& encoder, const MeshBuilder& builder, const Mesh& mesh,
               const QuantizationGrids& grids) {
  const auto set_grid = [&](int id, const QuantizationGrid& grid) {
    encoder.SetAttributeExplicitQuantization(id, grid.bits, static_cast<int>(grid.origin.size()), grid.origin.data(),
                                             grid.range);
  };
  set_grid(builder.position_id(), grids.position);
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    if (mesh.attributes[i].type != ComponentType::Float32) continue;
    const int id = builder.attribute_ids()[i];
    if (mesh.attributes[i].name == "NORMAL")
      encoder.SetAttributeQuantization(id, grids.attributes[i].bits);
    else
      set_grid(id, grids.attributes[i]);
  }
}

void set_coding(draco::ExpertEncoder& encoder, const MeshBuilder& builder, const Mesh& mesh,
                const DracoCoding& coding) {
  if (coding.method == DracoMethod::Sequential) encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  if (coding.prediction == DracoPrediction::Positions) return;
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i)
    if (draco_semantic(mesh.attributes[i]) == draco::GeometryAttribute::TEX_COORD)
      encoder.SetAttributePredictionScheme(builder.attribute_ids()[i], draco::MESH_PREDICTION_PARALLELOGRAM);
}

/// Draco multiplies differences by up to 2^30.
bool is_quantisable(std::span<const std::byte> values, float range) {
  constexpr float kLargest = std::numeric_limits<float>::max() / 4;
  if (!(range <= kLargest)) return false;
  for (std::size_t at = 0; at < values.size(); at += sizeof(float))
    if (!(std::abs(load_f32(values, at)) <= kLargest)) return false;
  return true;
}

}  // namespace

bool can_encode_draco(const Mesh& mesh, const QuantizationGrids& grids) {
  if (!is_quantisable(std::as_bytes(std::span(mesh.positions)), grids.position.range)) return false;
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i)
    if (mesh.attributes[i].type == ComponentType::Float32 &&
        !is_quantisable(mesh.attributes[i].data, grids.attributes[i].range))
      return false;
  return true;
}

Result<DracoPrimitive> encode_draco(const Mesh& mesh, const QuantizationGrids& grids, const DracoCoding& coding,
                                    int compression_level) {
  try {
    const MeshBuilder builder(mesh);
    draco::ExpertEncoder encoder(builder.mesh());
    encoder.SetSpeedOptions(10 - compression_level, 10 - compression_level);
    set_coding(encoder, builder, mesh, coding);
    set_grids(encoder, builder, mesh, grids);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeToBuffer(&buffer);
    if (!status.ok()) return fail(ErrorCode::Unsupported, text("Draco: ", status.error_msg_string()));

    DracoPrimitive primitive;
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    primitive.bytes.assign(bytes.begin(), bytes.end());
    primitive.position_id = builder.mesh().attribute(builder.position_id())->unique_id();
    for (const int id : builder.attribute_ids())
      primitive.attribute_ids.push_back(builder.mesh().attribute(id)->unique_id());
    return primitive;
  } catch (const std::exception& error) {
    return fail(ErrorCode::Unsupported, text("Draco: ", error.what()));
  }
}

}  // namespace lodestone::detail

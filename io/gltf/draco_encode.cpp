#include "gltf/draco_encode.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

// Draco counts how often each symbol comes in tables of four bytes for every one there can be: with 30 bits, 4 GiB.
constexpr int kMostTableBits = 24;

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

/// Nine digits tell every float from the next.
std::string exact_text(float value) { return number_text(static_cast<double>(value), 9); }

/// Draco's own setters write numbers into its options with six decimals, which small things do not survive.
void set_grid(draco::Options& options, const QuantizationGrid& grid) {
  options.SetInt("quantization_bits", grid.bits);
  std::string origin;
  for (const float value : grid.origin) origin.append(exact_text(value)).append(1, ' ');
  options.SetString("quantization_origin", origin);
  options.SetString("quantization_range", exact_text(grid.range));
}

/// Whether values span more steps of their grid than Draco can count the symbols of.
bool is_too_fine(std::span<const float> values, std::size_t component_count, const QuantizationGrid& grid) {
  if (grid.bits <= kMostTableBits) return false;
  double widest = 0;
  for (std::size_t c = 0; c < component_count; ++c) {
    float low = HUGE_VALF, high = -HUGE_VALF;
    for (std::size_t i = c; i < values.size(); i += component_count) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    widest = std::max(widest, (static_cast<double>(high) - static_cast<double>(low)) / grid.step());
  }
  return widest >= std::ldexp(1.0, kMostTableBits);
}

bool is_too_fine(const Mesh& mesh, const QuantizationGrids& grids) {
  const std::span positions(reinterpret_cast<const float*>(mesh.positions.data()), 3 * mesh.vertex_count());
  if (is_too_fine(positions, 3, grids.position)) return true;
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    const Attribute& a = mesh.attributes[i];
    if (a.type != ComponentType::Float32) continue;
    if (a.name == "NORMAL" && grids.attributes[i].bits > kMostTableBits) return true;
    if (is_too_fine(attribute_values(a), a.component_count, grids.attributes[i])) return true;
  }
  return false;
}

/// Stores what Draco predicts wrongly as it is, without any table of symbols; its highest levels have another.
void set_compression(draco::ExpertEncoder& encoder, int level, bool with_tables) {
  constexpr int kMostWithoutTables = 8;
  const int speed = 10 - (with_tables ? level : std::min(level, kMostWithoutTables));
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetUseBuiltInAttributeCompression(with_tables);
}

/// Says how an attribute is quantised, and how texture coordinates are predicted.
draco::Options attribute_options(const Attribute& attribute, const QuantizationGrid& grid, const DracoCoding& coding) {
  draco::Options options;
  const bool quantised = attribute.type == ComponentType::Float32 && !grid.is_exact();
  if (quantised && attribute.name == "NORMAL")
    options.SetInt("quantization_bits", grid.bits);
  else if (quantised)
    set_grid(options, grid);
  if (draco_semantic(attribute) == draco::GeometryAttribute::TEX_COORD &&
      coding.prediction == DracoPrediction::Neighbours)
    options.SetInt("prediction_scheme", draco::MESH_PREDICTION_PARALLELOGRAM);
  return options;
}

void set_attributes(draco::ExpertEncoder& encoder, const MeshBuilder& builder, const Mesh& mesh,
                    const QuantizationGrids& grids, const DracoCoding& coding) {
  draco::Options position;
  if (!grids.position.is_exact()) set_grid(position, grids.position);
  encoder.options().SetAttributeOptions(builder.position_id(), position);
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i)
    encoder.options().SetAttributeOptions(builder.attribute_ids()[i],
                                          attribute_options(mesh.attributes[i], grids.attributes[i], coding));
}

}  // namespace

Result<DracoPrimitive> encode_draco(const Mesh& mesh, const QuantizationGrids& grids, const DracoCoding& coding,
                                    int compression_level) {
  try {
    const MeshBuilder builder(mesh);
    draco::ExpertEncoder encoder(builder.mesh());
    set_compression(encoder, compression_level, !is_too_fine(mesh, grids));
    if (coding.method == DracoMethod::Sequential) encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    set_attributes(encoder, builder, mesh, grids, coding);
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

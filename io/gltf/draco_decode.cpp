#include "gltf/draco_decode.h"

#include <exception>
#include <memory>
#include <optional>

#include <draco/compression/decode.h>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"

namespace lodestone::detail {
namespace {

// Draco allocates for the counts in its header before it looks at the data behind them. A flat regular grid, the best
// case there is, takes a byte for 11 faces.
constexpr std::uint64_t kMaxFacesPerByte = 256;
constexpr std::uint64_t kMaxFaces = kNoIndex / 3;

constexpr std::size_t kHeaderBytes = 11;
constexpr std::uint8_t kMeshType = 1, kSequentialMethod = 0;
constexpr std::uint16_t kMetadataFlag = 0x8000;

/// Reads a base-128 number, low digits first.
std::optional<std::uint64_t> read_varint(std::span<const std::byte> bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 35 && at < bytes.size(); shift += 7) {
    const auto digit = static_cast<std::uint8_t>(bytes[at++]);
    value |= std::uint64_t{digit & 0x7fu} << shift;
    if (digit < 0x80) return value;
  }
  return std::nullopt;
}

struct Counts {
  std::uint64_t faces = 0;
  std::uint64_t points = 0;
};

/// Reads the counts Draco will trust.
std::optional<Counts> read_counts(std::span<const std::byte> bytes) {
  const bool sequential = load<std::uint8_t>(bytes, 8) == kSequentialMethod;
  std::size_t at = kHeaderBytes + (sequential ? 0 : 1);  // Edgebreaker names its kind of traversal first.
  const auto first = read_varint(bytes, at), second = read_varint(bytes, at);
  if (!first || !second) return std::nullopt;
  return sequential ? Counts{*first, *second} : Counts{*second, *first};
}

Result<void> check_header(std::span<const std::byte> bytes, std::string_view where) {
  if (bytes.size() < kHeaderBytes || !as_text(bytes).starts_with("DRACO") || load<std::uint8_t>(bytes, 7) != kMeshType)
    return fail(ErrorCode::Malformed, text(where, ": no Draco mesh"));
  const int major = load<std::uint8_t>(bytes, 5), minor = load<std::uint8_t>(bytes, 6);
  if (major != 2 || minor != 2)
    return fail(ErrorCode::Unsupported, text(where, ": Draco bitstream ", major, '.', minor, ", where glTF means 2.2"));
  // Metadata stands before the counts; glTF writers do not use it, and Draco's own checks have to do.
  if (load<std::uint16_t>(bytes, 9) & kMetadataFlag) return {};
  const auto counts = read_counts(bytes);
  if (!counts) return fail(ErrorCode::Malformed, text(where, ": Draco data ends inside its header"));
  const std::uint64_t limit = std::min(kMaxFaces, kMaxFacesPerByte * bytes.size());
  if (counts->faces <= limit && counts->points <= 3 * limit) return {};
  return fail(ErrorCode::LimitExceeded, text(where, ": Draco counts of ", counts->faces, " faces and ", counts->points,
                                             " points cannot come from ", bytes.size(), " bytes"));
}

Result<std::unique_ptr<draco::Mesh>> decode_mesh(std::span<const std::byte> bytes, std::string_view where) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  try {
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) return std::move(decoded).value();
    return fail(ErrorCode::Malformed, text(where, ": Draco: ", decoded.status().error_msg_string()));
  } catch (const std::exception& error) {
    return fail(ErrorCode::Malformed, text(where, ": Draco: ", error.what()));
  }
}

Result<std::vector<Index>> copy_indices(const draco::Mesh& mesh, std::string_view where) {
  std::vector<Index> indices;
  indices.reserve(3 * std::size_t{mesh.num_faces()});
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& point : mesh.face(f)) {
      if (point.value() >= mesh.num_points())
        return fail(ErrorCode::Malformed,
                    text(where, ": Draco index ", point.value(), " is out of range: there are ", mesh.num_points()));
      indices.push_back(point.value());
    }
  return indices;
}

/// Converts a whole attribute; false where a value does not fit its type.
template <class T>
bool convert(const draco::PointAttribute& source, std::size_t point_count, AccessorData& out) {
  auto* values = reinterpret_cast<T*>(out.bytes.data());
  for (std::size_t i = 0; i < point_count; ++i) {
    const auto value = source.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= source.size()) return false;
    if (!source.ConvertValue<T>(value, static_cast<std::int8_t>(out.component_count), values + i * out.component_count))
      return false;
  }
  return true;
}

bool convert_to(ComponentType type, const draco::PointAttribute& source, std::size_t point_count, AccessorData& out) {
  switch (type) {
    case ComponentType::Int8:
      return convert<std::int8_t>(source, point_count, out);
    case ComponentType::UInt8:
      return convert<std::uint8_t>(source, point_count, out);
    case ComponentType::Int16:
      return convert<std::int16_t>(source, point_count, out);
    case ComponentType::UInt16:
      return convert<std::uint16_t>(source, point_count, out);
    case ComponentType::UInt32:
      return convert<std::uint32_t>(source, point_count, out);
    case ComponentType::Float32:
      return convert<float>(source, point_count, out);
  }
  return false;
}

Result<AccessorData> copy_attribute(const draco::Mesh& mesh, const DracoRequest& request, std::string_view where) {
  const draco::PointAttribute* source = mesh.GetAttributeByUniqueId(request.unique_id);
  if (source == nullptr)
    return fail(ErrorCode::Malformed, text(where, ": Draco attribute ", request.unique_id, " does not exist"));
  if (source->num_components() != request.component_count)
    return fail(ErrorCode::Malformed,
                text(where, ": Draco attribute ", request.unique_id, " has ", int{source->num_components()},
                     " components and not ", int{request.component_count}));
  AccessorData out{request.type, request.component_count, request.normalized, mesh.num_points(), {}};
  out.bytes.resize(out.count * out.element_bytes());
  if (convert_to(request.type, *source, out.count, out)) return out;
  return fail(ErrorCode::Malformed, text(where, ": Draco attribute ", request.unique_id, " does not fit its accessor"));
}

}  // namespace

Result<DracoGeometry> decode_draco(std::span<const std::byte> bytes, std::span<const DracoRequest> requests,
                                   std::string_view where) {
  LODESTONE_CHECK(check_header(bytes, where));
  LODESTONE_TRY(const std::unique_ptr<draco::Mesh> mesh, decode_mesh(bytes, where));
  DracoGeometry geometry;
  geometry.point_count = mesh->num_points();
  LODESTONE_TRY(geometry.indices, copy_indices(*mesh, where));
  for (const DracoRequest& request : requests) {
    LODESTONE_TRY(AccessorData attribute, copy_attribute(*mesh, request, where));
    geometry.attributes.push_back(std::move(attribute));
  }
  return geometry;
}

}  // namespace lodestone::detail

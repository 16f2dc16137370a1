#include "gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "gltf/gltf_container.h"
#include "gltf/meshopt_decode.h"

namespace lodestone::detail {
namespace {

// What a file may ask for beyond its own bytes: accessors without a bufferView (all zeros), and meshopt views, several
// of which may share their compressed bytes.
constexpr std::size_t kMaxExpansion = 256;
constexpr std::size_t kAlwaysAllowedBytes = std::size_t{1} << 20;

constexpr std::array<const char*, 13> kTopLevelArrays = {
    "accessors", "animations", "buffers",  "bufferViews", "cameras", "images",  "materials",
    "meshes",    "nodes",      "samplers", "scenes",      "skins",   "textures"};

/// Checks once that every top-level array is an array of objects, so that `element` may rely on it.
Result<void> check_shape(const Json& json) {
  if (!json.is_object()) return fail(ErrorCode::Malformed, "gltf: the document is not an object");
  for (const char* name : kTopLevelArrays) {
    const Json* array = find_member(json, name);
    if (array == nullptr) continue;
    if (!array->is_array()) return fail(ErrorCode::Malformed, text("gltf: ", name, " is not an array"));
    for (std::size_t i = 0; i < array->size(); ++i)
      if (!(*array)[i].is_object())
        return fail(ErrorCode::Malformed, text("gltf: ", name, '[', i, "] is not an object"));
  }
  return {};
}

Result<void> check_version(const Json& json) {
  const Json* asset = find_member(json, "asset");
  const std::string version = asset != nullptr ? string_member(*asset, "version") : "";
  if (version.empty()) return fail(ErrorCode::Malformed, "gltf: asset.version is missing");
  const std::string least = string_member(*asset, "minVersion");
  if (version.starts_with("2.") && (least.empty() || least == "2.0")) return {};
  return fail(ErrorCode::Unsupported,
              text("gltf: version ", least.empty() ? version : least, " is not supported, only 2.0"));
}

const Json* meshopt_extension(const Json& object) {
  const Json* found = GltfDocument::extension(object, "EXT_meshopt_compression");
  return found != nullptr ? found : GltfDocument::extension(object, "KHR_meshopt_compression");
}

/// A buffer that only stands in for clients without meshopt holds no bytes of its own.
bool is_fallback(const Json& buffer) {
  const Json* extension = meshopt_extension(buffer);
  const Json* flag = extension != nullptr ? find_member(*extension, "fallback") : nullptr;
  return flag != nullptr && flag->is_boolean() && flag->get<bool>();
}

std::optional<ComponentType> component_type_of(std::size_t value) {
  switch (value) {
    case 5120:
      return ComponentType::Int8;
    case 5121:
      return ComponentType::UInt8;
    case 5122:
      return ComponentType::Int16;
    case 5123:
      return ComponentType::UInt16;
    case 5125:
      return ComponentType::UInt32;
    case 5126:
      return ComponentType::Float32;
    default:
      return std::nullopt;
  }
}

/// Returns 1 to 4, 16 for the matrices of skins, or 0 for other matrices and unknown types.
std::uint8_t component_count_of(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  return 0;
}

Result<AccessorData> read_accessor_type(const Json& accessor, std::string_view where) {
  AccessorData data;
  LODESTONE_TRY(const std::size_t component_type, size_member(accessor, "componentType", where));
  const auto type = component_type_of(component_type);
  if (!type) return fail(ErrorCode::Malformed, text(where, ": componentType ", component_type));
  data.type = *type;
  const std::string shape = string_member(accessor, "type");
  data.component_count = component_count_of(shape);
  if (data.component_count == 0) return fail(ErrorCode::Unsupported, text(where, ": type '", shape, "'"));
  const Json* normalized = find_member(accessor, "normalized");
  data.normalized = normalized != nullptr && normalized->is_boolean() && normalized->get<bool>();
  LODESTONE_TRY(data.count, size_member(accessor, "count", where));
  return data;
}

/// Returns the distance of `count` elements that begin at `offset` of a view, after checking that they lie inside.
Result<std::size_t> check_range(const BufferView& view, std::size_t offset, std::size_t count,
                                std::size_t element_bytes, std::string_view where) {
  const std::size_t stride = view.stride == 0 ? element_bytes : view.stride;
  if (stride < element_bytes)
    return fail(ErrorCode::Malformed, text(where, ": elements of ", element_bytes, " bytes in a stride of ", stride));
  if (count == 0) return stride;
  const bool first_fits = offset <= view.bytes.size() && element_bytes <= view.bytes.size() - offset;
  if (!first_fits || count - 1 > (view.bytes.size() - offset - element_bytes) / stride)
    return fail(ErrorCode::Malformed, text(where, ": count ", count, " from byte ", offset, " exceeds buffer view of ",
                                           view.bytes.size(), " bytes"));
  return stride;
}

/// Copies elements out of a view into tightly packed bytes.
Result<void> gather(const BufferView& view, std::size_t offset, std::size_t count, std::size_t element_bytes,
                    std::string_view where, std::vector<std::byte>& out) {
  LODESTONE_TRY(const std::size_t stride, check_range(view, offset, count, element_bytes, where));
  out.resize(count * element_bytes);
  if (stride == element_bytes) {
    std::copy_n(view.bytes.begin() + offset, out.size(), out.begin());
    return {};
  }
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(view.bytes.begin() + offset + i * stride, element_bytes, out.begin() + i * element_bytes);
  return {};
}

/// Replaces the elements that the accessor's `sparse` object lists.
Result<void> apply_sparse(const GltfDocument& document, const Json& sparse, AccessorData& data,
                          const std::string& where) {
  LODESTONE_TRY(const std::size_t count, size_member(sparse, "count", where));
  const Json* indices = find_member(sparse, "indices");
  const Json* values = find_member(sparse, "values");
  if (indices == nullptr || values == nullptr) return fail(ErrorCode::Malformed, text(where, ": no indices or values"));

  AccessorData places{ComponentType::UInt32, 1, false, count, {}};
  LODESTONE_TRY(const std::size_t index_type, size_member(*indices, "componentType", where));
  places.type = component_type_of(index_type).value_or(ComponentType::Float32);
  LODESTONE_TRY(const std::size_t index_view, size_member(*indices, "bufferView", where));
  LODESTONE_TRY(const std::size_t index_offset, size_member_or(*indices, "byteOffset", 0, where));
  LODESTONE_TRY(BufferView view, document.buffer_view(index_view));
  LODESTONE_CHECK(gather(view, index_offset, count, places.element_bytes(), where + " indices", places.bytes));
  LODESTONE_TRY(const std::vector<Index> targets, to_indices(places, where));

  std::vector<std::byte> replacements;
  LODESTONE_TRY(const std::size_t value_view, size_member(*values, "bufferView", where));
  LODESTONE_TRY(const std::size_t value_offset, size_member_or(*values, "byteOffset", 0, where));
  LODESTONE_TRY(view, document.buffer_view(value_view));
  LODESTONE_CHECK(gather(view, value_offset, count, data.element_bytes(), where + " values", replacements));
  for (std::size_t i = 0; i < count; ++i) {
    if (targets[i] >= data.count)
      return fail(ErrorCode::Malformed, text(where, ": index ", targets[i], " is out of range: count is ", data.count));
    std::copy_n(replacements.begin() + i * data.element_bytes(), data.element_bytes(),
                data.bytes.begin() + targets[i] * data.element_bytes());
  }
  return {};
}

}  // namespace

Result<GltfDocument> GltfDocument::parse(std::span<const std::byte> bytes, const FileFetcher& fetch) {
  LODESTONE_TRY(const GltfContainer container, split_container(bytes));
  GltfDocument document;
  LODESTONE_TRY(document.json_, parse_json(container.json));
  LODESTONE_CHECK(check_shape(document.json_));
  LODESTONE_CHECK(check_version(document.json_));
  LODESTONE_CHECK(document.load_buffers({container.binary.begin(), container.binary.end()}, fetch));
  LODESTONE_CHECK(document.decompress_views());
  return document;
}

const Json& GltfDocument::list(const char* array) const {
  static const Json kNone = Json::array();
  const Json* found = find_member(json_, array);
  return found == nullptr ? kNone : *found;
}

std::size_t GltfDocument::count(const char* array) const { return list(array).size(); }

Result<const Json*> GltfDocument::element(const char* array, const char* what, std::size_t index) const {
  if (index < count(array)) return &list(array)[index];
  return fail(ErrorCode::Malformed, text(what, ' ', index, " does not exist: the file has ", count(array)));
}

const Json* GltfDocument::extension(const Json& object, const char* name) {
  const Json* extensions = find_member(object, "extensions");
  const Json* found = extensions != nullptr ? find_member(*extensions, name) : nullptr;
  return found != nullptr && found->is_object() ? found : nullptr;
}

Result<void> GltfDocument::load_buffers(std::vector<std::byte> binary_chunk, const FileFetcher& fetch) {
  for (std::size_t i = 0; i < count("buffers"); ++i) {
    const std::string where = text("buffer ", i);
    LODESTONE_TRY(const Json* const buffer, element("buffers", "buffer", i));
    LODESTONE_TRY(const std::size_t size, size_member(*buffer, "byteLength", where));
    const std::string uri = string_member(*buffer, "uri");
    std::vector<std::byte> bytes;
    if (is_fallback(*buffer)) {
      content_->buffers.emplace_back();
      continue;
    }
    if (uri.empty()) {
      if (i > 0) return fail(ErrorCode::Malformed, where + ": no uri, and only buffer 0 may be the binary chunk");
      bytes = std::exchange(binary_chunk, {});
    } else if (uri.starts_with("data:")) {
      LODESTONE_TRY(bytes, decode_data_uri(uri, where));
    } else {
      LODESTONE_TRY(const std::filesystem::path path, uri_to_path(uri, where));
      auto fetched = fetch(path);
      if (!fetched) return fail(fetched.error().code, text(where, ": ", fetched.error().message));
      bytes = std::move(*fetched);
    }
    if (bytes.size() < size)
      return fail(ErrorCode::Malformed,
                  text(where, ": byteLength ", size, " where there are ", bytes.size(), " bytes"));
    bytes.resize(size);
    content_->buffers.push_back(std::move(bytes));
  }
  return {};
}

std::size_t GltfDocument::expansion_limit() const {
  std::size_t limit = kAlwaysAllowedBytes;
  for (const auto& buffer : content_->buffers) limit += kMaxExpansion * buffer.size();
  return limit;
}

/// Returns the bytes that buffer, byteOffset and byteLength of a bufferView (or of its extension) name.
Result<std::span<const std::byte>> GltfDocument::slice_buffer(const Json& object, std::string_view where) const {
  LODESTONE_TRY(const std::size_t buffer, size_member(object, "buffer", where));
  LODESTONE_TRY(const std::size_t offset, size_member_or(object, "byteOffset", 0, where));
  LODESTONE_TRY(const std::size_t size, size_member(object, "byteLength", where));
  if (buffer >= content_->buffers.size())
    return fail(ErrorCode::Malformed,
                text(where, ": buffer ", buffer, " does not exist: the file has ", content_->buffers.size()));
  const std::span<const std::byte> bytes = content_->buffers[buffer];
  if (offset > bytes.size() || size > bytes.size() - offset)
    return fail(ErrorCode::Malformed, text(where, ": ", size, " bytes from ", offset, " exceed buffer ", buffer, " of ",
                                           bytes.size(), " bytes"));
  return bytes.subspan(offset, size);
}

Result<void> GltfDocument::decompress_views() {
  content_->decompressed_views.resize(count("bufferViews"));
  std::size_t budget = expansion_limit();
  for (std::size_t i = 0; i < content_->decompressed_views.size(); ++i) {
    LODESTONE_TRY(const Json* const view, element("bufferViews", "buffer view", i));
    const Json* extension = meshopt_extension(*view);
    if (extension == nullptr) continue;
    const std::string where = text("buffer view ", i);
    LODESTONE_TRY(const auto compressed, slice_buffer(*extension, where));
    LODESTONE_TRY(content_->decompressed_views[i], decode_meshopt(*extension, compressed, budget, where));
    budget -= content_->decompressed_views[i].size();
  }
  return {};
}

Result<BufferView> GltfDocument::buffer_view(std::size_t index) const {
  const std::string where = text("buffer view ", index);
  LODESTONE_TRY(const Json* const json, element("bufferViews", "buffer view", index));
  BufferView view;
  if (const Json* extension = meshopt_extension(*json)) {
    view.bytes = content_->decompressed_views[index];
    LODESTONE_TRY(view.stride, size_member(*extension, "byteStride", where));
    return view;
  }
  LODESTONE_TRY(view.bytes, slice_buffer(*json, where));
  LODESTONE_TRY(view.stride, size_member_or(*json, "byteStride", 0, where));
  return view;
}

Result<GltfDocument::StoredView> GltfDocument::stored_view(std::size_t index) const {
  LODESTONE_TRY(const Json* const json, element("bufferViews", "buffer view", index));
  const Json* extension = meshopt_extension(*json);
  StoredView view{0, extension != nullptr};
  LODESTONE_TRY(view.byte_length,
                size_member(view.packed ? *extension : *json, "byteLength", text("buffer view ", index)));
  return view;
}

Result<AccessorData> GltfDocument::accessor_type(std::size_t index) const {
  LODESTONE_TRY(const Json* const json, element("accessors", "accessor", index));
  return read_accessor_type(*json, text("accessor ", index));
}

Result<AccessorData> GltfDocument::accessor(std::size_t index) const {
  const std::string where = text("accessor ", index);
  LODESTONE_TRY(const Json* const json, element("accessors", "accessor", index));
  LODESTONE_TRY(AccessorData data, read_accessor_type(*json, where));
  if (find_member(*json, "bufferView") != nullptr) {
    LODESTONE_TRY(const std::size_t view_index, size_member(*json, "bufferView", where));
    LODESTONE_TRY(const std::size_t offset, size_member_or(*json, "byteOffset", 0, where));
    LODESTONE_TRY(const BufferView view, buffer_view(view_index));
    LODESTONE_CHECK(gather(view, offset, data.count, data.element_bytes(), where, data.bytes));
  } else {
    if (data.count > expansion_limit() / data.element_bytes())
      return fail(ErrorCode::LimitExceeded, text(where, ": count ", data.count, " without a buffer view"));
    data.bytes.resize(data.count * data.element_bytes());
  }
  if (const Json* sparse = find_member(*json, "sparse"))
    LODESTONE_CHECK(apply_sparse(*this, *sparse, data, where + " sparse"));
  return data;
}

namespace {

template <class T>
void convert_to_indices(const AccessorData& data, std::vector<Index>& out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = load<T>(data.bytes, i * sizeof(T));
}

}  // namespace

std::vector<float> to_floats(const AccessorData& data) {
  return component_values(data.type, data.normalized, data.bytes);
}

Result<std::vector<Index>> to_indices(const AccessorData& data, std::string_view what) {
  std::vector<Index> out(data.count);
  if (data.component_count == 1 && data.type == ComponentType::UInt8)
    convert_to_indices<std::uint8_t>(data, out);
  else if (data.component_count == 1 && data.type == ComponentType::UInt16)
    convert_to_indices<std::uint16_t>(data, out);
  else if (data.component_count == 1 && data.type == ComponentType::UInt32)
    convert_to_indices<std::uint32_t>(data, out);
  else
    return fail(ErrorCode::Malformed, text(what, ": indices are not unsigned scalars"));
  return out;
}

}  // namespace lodestone::detail

#include "gltf/glb_builder.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <lodestone/core/detail/text.h>

#include "base/bytes.h"
#include "gltf/gltf_container.h"

namespace lodestone::detail {
namespace {

constexpr const char* kMeshopt = "EXT_meshopt_compression";

void pad_to_four(std::vector<std::byte>& bytes, std::byte filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(filler);
}

void append_chunk(std::vector<std::byte>& out, std::uint32_t type, std::span<const std::byte> bytes) {
  append(out, static_cast<std::uint32_t>(bytes.size()));
  append(out, type);
  append_bytes(out, bytes);
}

void list_once(Json& document, const char* list, const char* name) {
  Json& names = document[list];
  if (names.is_null()) names = Json::array();
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

Result<std::vector<std::byte>> join_chunks(std::string json, std::vector<std::byte> binary) {
  while (json.size() % 4 != 0) json.push_back(' ');
  pad_to_four(binary, std::byte{0});
  const std::uint64_t total = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (total > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::LimitExceeded, text("glb: ", total, " bytes are more than the format can hold"));
  std::vector<std::byte> out;
  out.reserve(total);
  append(out, kGlbMagic);
  append(out, std::uint32_t{2});
  append(out, static_cast<std::uint32_t>(total));
  append_chunk(out, kGlbJsonChunk, std::as_bytes(std::span(json)));
  if (!binary.empty()) append_chunk(out, kGlbBinaryChunk, binary);
  return out;
}

}  // namespace

const char* const kGenerator = "lodestone 0.1.0";

GlbBuilder::GlbBuilder(Json document, FreeSlots free_slots)
    : document_(std::move(document)), free_slots_(std::move(free_slots)) {}

std::size_t GlbBuilder::add(const char* array, Json object) {
  Json& list = document_[array];
  if (list.is_null()) list = Json::array();
  std::vector<std::size_t>& free = free_slots_[array];
  if (free.empty()) {
    list.push_back(std::move(object));
    return list.size() - 1;
  }
  const std::size_t index = free.front();
  free.erase(free.begin());
  list[index] = std::move(object);
  return index;
}

std::uint64_t GlbBuilder::add_bytes(std::span<const std::byte> bytes, std::size_t alignment, std::size_t remainder) {
  while (binary_.size() % alignment != remainder % alignment) binary_.push_back(std::byte{0});
  const std::uint64_t offset = binary_.size();
  append_bytes(binary_, bytes);
  return offset;
}

std::size_t GlbBuilder::add_view(std::span<const std::byte> bytes, ViewTarget target, std::size_t stride) {
  const std::uint64_t offset = add_bytes(bytes, 4);
  Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (stride > 0) view["byteStride"] = stride;
  if (target != ViewTarget::None) view["target"] = static_cast<int>(target);
  return add("bufferViews", std::move(view));
}

std::size_t GlbBuilder::add_packed_view(const MeshoptView& packed, ViewTarget target) {
  Json extension = {{"buffer", 0},
                    {"byteOffset", add_bytes(packed.bytes, 4)},
                    {"byteLength", packed.bytes.size()},
                    {"byteStride", packed.stride},
                    {"count", packed.count},
                    {"mode", packed.mode == MeshoptMode::Triangles ? "TRIANGLES" : "ATTRIBUTES"}};
  if (packed.filter == MeshoptFilter::Octahedral) extension["filter"] = "OCTAHEDRAL";
  if (packed.filter == MeshoptFilter::Exponential) extension["filter"] = "EXPONENTIAL";
  Json view = {{"buffer", 1}, {"byteOffset", unpacked_bytes_}, {"byteLength", packed.unpacked_bytes()}};
  if (target == ViewTarget::Vertices) view["byteStride"] = packed.stride;
  if (target != ViewTarget::None) view["target"] = static_cast<int>(target);
  view["extensions"][kMeshopt] = std::move(extension);
  unpacked_bytes_ += padded_to_four(packed.unpacked_bytes());
  require_extension(kMeshopt);
  return add("bufferViews", std::move(view));
}

void GlbBuilder::use_extension(const char* name) { list_once(document_, "extensionsUsed", name); }

void GlbBuilder::require_extension(const char* name) {
  use_extension(name);
  list_once(document_, "extensionsRequired", name);
}

/// Free objects at the end go; those before others stay as the least that is valid, since numbers must not change.
void GlbBuilder::fill_free_slots(const char* array, const Json& filler) {
  std::vector<std::size_t>& free = free_slots_[array];
  if (free.empty()) return;
  Json& list = document_[array];
  for (; !free.empty() && free.back() + 1 == list.size(); free.pop_back()) list.erase(list.size() - 1);
  for (const std::size_t index : free) list[index] = filler;
  free.clear();
  if (list.empty()) document_.erase(array);
}

void GlbBuilder::close_document() {
  fill_free_slots("accessors", {{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}});
  fill_free_slots("bufferViews", {{"buffer", 0}, {"byteLength", 1}});
  if (binary_.empty() && document_.contains("bufferViews")) binary_.resize(4);
  document_.erase("buffers");
  if (!binary_.empty()) document_["buffers"] = Json::array({Json{{"byteLength", binary_.size()}}});
  if (unpacked_bytes_ == 0) return;
  Json unpacked = {{"byteLength", unpacked_bytes_}};
  unpacked["extensions"][kMeshopt]["fallback"] = true;
  document_["buffers"].push_back(std::move(unpacked));
}

Result<std::vector<std::byte>> GlbBuilder::finish() {
  close_document();
  return join_chunks(document_.dump(-1, ' ', false, Json::error_handler_t::replace), std::move(binary_));
}

GlbBuilder::SeparateFiles GlbBuilder::finish_separate(const std::string& binary_uri) {
  close_document();
  if (!binary_.empty()) document_["buffers"][0]["uri"] = binary_uri;
  return {document_.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", std::move(binary_)};
}

}  // namespace lodestone::detail

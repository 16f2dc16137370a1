#include "glb_builder.h"

#include <array>
#include <limits>

#include "bytes.h"
#include "gltf_container.h"
#include "text.h"

namespace lodestone::detail {
namespace {

constexpr const char* kGenerator = "lodestone 0.1.0";

void pad_to_four(std::vector<std::byte>& bytes, std::byte filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(filler);
}

void append_chunk(std::vector<std::byte>& out, std::uint32_t type, std::span<const std::byte> bytes) {
  append(out, static_cast<std::uint32_t>(bytes.size()));
  append(out, type);
  append_bytes(out, bytes);
}

}  // namespace

std::size_t GlbBuilder::add(const char* array, Json object) {
  Json& list = arrays_[array];
  if (list.is_null()) list = Json::array();
  list.push_back(std::move(object));
  return list.size() - 1;
}

std::size_t GlbBuilder::add_view(std::span<const std::byte> bytes, ViewTarget target, std::size_t stride) {
  pad_to_four(binary_, std::byte{0});
  Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  if (stride > 0) view["byteStride"] = stride;
  if (target != ViewTarget::None) view["target"] = static_cast<int>(target);
  append_bytes(binary_, bytes);
  return add("bufferViews", std::move(view));
}

Json GlbBuilder::document() const {
  Json json;
  json["asset"] = {{"version", "2.0"}, {"generator", kGenerator}};
  if (!used_.empty()) json["extensionsUsed"] = used_;
  if (!required_.empty()) json["extensionsRequired"] = required_;
  if (arrays_.contains("scenes")) json["scene"] = 0;
  for (const char* name : {"scenes", "nodes", "meshes", "materials", "accessors", "bufferViews"})
    if (arrays_.contains(name)) json[name] = arrays_[name];
  if (!binary_.empty()) json["buffers"] = Json::array({Json{{"byteLength", binary_.size()}}});
  return json;
}

Result<std::vector<std::byte>> GlbBuilder::finish() const {
  std::string source = document().dump(-1, ' ', false, Json::error_handler_t::replace);
  while (source.size() % 4 != 0) source.push_back(' ');
  std::vector<std::byte> binary = binary_;
  pad_to_four(binary, std::byte{0});

  const std::uint64_t total = 12 + 8 + source.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (total > std::numeric_limits<std::uint32_t>::max())
    return fail(ErrorCode::LimitExceeded, text("glb: ", total, " bytes are more than the format can hold"));
  std::vector<std::byte> out;
  out.reserve(total);
  append(out, kGlbMagic);
  append(out, std::uint32_t{2});
  append(out, static_cast<std::uint32_t>(total));
  append_chunk(out, kGlbJsonChunk, std::as_bytes(std::span(source)));
  if (!binary.empty()) append_chunk(out, kGlbBinaryChunk, binary);
  return out;
}

}  // namespace lodestone::detail

#include "scene/stream_extension.h"

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "codec/compact_layout.h"

namespace lodestone::detail {

namespace {

constexpr std::size_t kMajorAt = 8, kMinorAt = 10;

}  // namespace

bool is_compact(std::span<const std::byte> stream) {
  return stream.size() >= kMinorAt && load<std::uint16_t>(stream, kMajorAt) == kCompactMajor;
}

std::string stream_version(std::span<const std::byte> stream) {
  return text(load<std::uint16_t>(stream, kMajorAt), ".", load<std::uint16_t>(stream, kMinorAt));
}

Result<std::vector<std::byte>> stored_stream(const GltfDocument& document, std::size_t mesh) {
  LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", mesh));
  const Json* extension = GltfDocument::extension(*json, kStreamExtension);
  if (extension == nullptr) return std::vector<std::byte>{};
  LODESTONE_TRY(const std::size_t view_index, size_member(*extension, "bufferView", kStreamExtension));
  LODESTONE_TRY(const BufferView view, document.buffer_view(view_index));
  return std::vector<std::byte>(view.bytes.begin(), view.bytes.end());
}

}  // namespace lodestone::detail

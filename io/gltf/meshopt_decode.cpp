#include "gltf/meshopt_decode.h"

#include <string>

#include <meshoptimizer.h>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone::detail {
namespace {

struct Layout {
  std::string mode;
  std::string filter;
  std::size_t count = 0;
  std::size_t stride = 0;
};

Result<Layout> read_layout(const Json& extension, std::string_view where) {
  Layout layout{string_member(extension, "mode"), string_member(extension, "filter"), 0, 0};
  LODESTONE_TRY(layout.count, size_member(extension, "count", where));
  LODESTONE_TRY(layout.stride, size_member(extension, "byteStride", where));
  return layout;
}

bool stride_fits(const Layout& layout) {
  if (layout.mode != "ATTRIBUTES") return layout.stride == 2 || layout.stride == 4;
  if (layout.filter == "OCTAHEDRAL") return layout.stride == 4 || layout.stride == 8;
  if (layout.filter == "QUATERNION") return layout.stride == 8;
  return layout.stride >= 4 && layout.stride <= 256 && layout.stride % 4 == 0;
}

/// Returns meshoptimizer's result code: 0 is success.
int decode(const Layout& layout, std::span<const std::byte> compressed, std::vector<std::byte>& out) {
  const auto* source = reinterpret_cast<const unsigned char*>(compressed.data());
  if (layout.mode == "ATTRIBUTES")
    return meshopt_decodeVertexBuffer(out.data(), layout.count, layout.stride, source, compressed.size());
  if (layout.mode == "TRIANGLES")
    return layout.count % 3 == 0
               ? meshopt_decodeIndexBuffer(out.data(), layout.count, layout.stride, source, compressed.size())
               : -1;
  return meshopt_decodeIndexSequence(out.data(), layout.count, layout.stride, source, compressed.size());
}

/// The filters work in place. Those of meshoptimizer take any count.
void apply_filter(const Layout& layout, std::vector<std::byte>& out) {
  if (layout.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), layout.count, layout.stride);
  if (layout.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), layout.count, layout.stride);
  if (layout.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), layout.count, layout.stride);
}

bool known(const Layout& layout) {
  const bool known_mode = layout.mode == "ATTRIBUTES" || layout.mode == "TRIANGLES" || layout.mode == "INDICES";
  const bool known_filter = layout.filter.empty() || layout.filter == "NONE" || layout.filter == "OCTAHEDRAL" ||
                            layout.filter == "QUATERNION" || layout.filter == "EXPONENTIAL";
  return known_mode && known_filter;
}

}  // namespace

Result<std::vector<std::byte>> decode_meshopt(const Json& extension, std::span<const std::byte> compressed,
                                              std::size_t max_bytes, std::string_view where) {
  LODESTONE_TRY(const Layout layout, read_layout(extension, where));
  if (!known(layout))
    return fail(ErrorCode::Unsupported,
                text(where, ": meshopt mode '", layout.mode, "' with filter '", layout.filter, "'"));
  if (!stride_fits(layout)) return fail(ErrorCode::Malformed, text(where, ": meshopt stride ", layout.stride));
  if (layout.count > max_bytes / layout.stride)
    return fail(ErrorCode::LimitExceeded,
                text(where, ": count ", layout.count, " of stride ", layout.stride, " exceeds ", max_bytes, " bytes"));
  std::vector<std::byte> out(layout.count * layout.stride);
  if (decode(layout, compressed, out) != 0) return fail(ErrorCode::Malformed, text(where, ": broken meshopt data"));
  if (layout.mode == "ATTRIBUTES") apply_filter(layout, out);
  return out;
}

}  // namespace lodestone::detail

#include "heatmap.h"

#include <cstdint>

#include <lodestone/io/file.h>
#include <lodestone/io/write_mesh.h>

#include "colour_map.h"
#include "file_words.h"
#include "messages.h"

namespace lodestone::tool {
namespace {

void append_u16(std::vector<std::byte>& out, std::uint16_t value) {
  out.push_back(static_cast<std::byte>(value & 0xff));
  out.push_back(static_cast<std::byte>(value >> 8));
}

/// Linear light, for which eight bits are too few.
Attribute colours(const Mesh& mesh, std::span<const float> errors, double upper) {
  Attribute out{"COLOR_0", ComponentType::UInt16, 4, true, {}};
  for (const Index v : mesh.wedge_vertex) {
    for (const std::uint16_t component : linear_error_colour(upper > 0 ? errors[v] / upper : 0))
      append_u16(out.data, component);
    append_u16(out.data, 0xffff);
  }
  return out;
}

}  // namespace

Result<void> check_heatmap_path(const std::filesystem::path& path) {
  if (extension_of(path) == "ply" || extension_of(path) == "glb") return {};
  return fail(ErrorCode::InvalidArgument, "--heatmap: " + quoted(path) + " does not end in .ply or .glb");
}

Result<std::vector<std::byte>> encode_heatmap(const std::filesystem::path& path, const Mesh& mesh,
                                              std::span<const float> errors, double upper) {
  Mesh out = mesh;
  std::erase_if(out.attributes, [](const Attribute& attribute) { return attribute.name != "NORMAL"; });
  out.attributes.push_back(colours(mesh, errors, upper));
  out.face_material.clear();
  return write_mesh_bytes(out, path);
}

}  // namespace lodestone::tool

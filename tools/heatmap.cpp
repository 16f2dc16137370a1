#include "heatmap.h"

#include <cstdint>

#include <lodestone/io/write_mesh.h>

#include "colour_map.h"
#include "messages.h"

namespace lodestone::tool {
namespace {

void append_u16(std::vector<std::byte>& out, std::uint16_t value) {
  out.push_back(static_cast<std::byte>(value & 0xff));
  out.push_back(static_cast<std::byte>(value >> 8));
}

/// glTF's colours are linear light, for which eight bits are too few; PLY's are shown as they are.
Attribute colours(bool linear, const Mesh& mesh, std::span<const float> errors, double upper) {
  Attribute out{
      "COLOR_0", linear ? ComponentType::UInt16 : ComponentType::UInt8, std::uint8_t(linear ? 4 : 3), true, {}};
  for (const Index v : mesh.wedge_vertex) {
    const double share = upper > 0 ? errors[v] / upper : 0;
    if (linear) {
      for (const std::uint16_t component : linear_error_colour(share)) append_u16(out.data, component);
      append_u16(out.data, 0xffff);
    } else {
      const Colour colour = error_colour(share);
      for (const std::uint8_t component : {colour.red, colour.green, colour.blue})
        out.data.push_back(static_cast<std::byte>(component));
    }
  }
  return out;
}

}  // namespace

Result<void> check_heatmap_path(const std::filesystem::path& path) {
  if (path.extension() == ".ply" || path.extension() == ".glb") return {};
  return fail(ErrorCode::InvalidArgument, "--heatmap: " + quoted(path) + " does not end in .ply or .glb");
}

Result<std::vector<std::byte>> encode_heatmap(const std::filesystem::path& path, const Mesh& mesh,
                                              std::span<const float> errors, double upper) {
  Mesh out = mesh;
  std::erase_if(out.attributes, [](const Attribute& attribute) { return attribute.name != "NORMAL"; });
  out.attributes.push_back(colours(path.extension() == ".glb", mesh, errors, upper));
  out.face_material.clear();
  return write_mesh_bytes(out, path);
}

}  // namespace lodestone::tool

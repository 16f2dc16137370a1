#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include "base/bytes.h"
#include "mesh/mesh_writers.h"

namespace lodestone::detail {
namespace {

template <class T>
void append_number(std::string& out, T value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);  // floats: shortest exact
  out.append(buffer.data(), result.ptr);
}

void append_line(std::string& out, const char* keyword, std::initializer_list<float> values) {
  out += keyword;
  for (const float value : values) {
    out += ' ';
    append_number(out, value);
  }
  out += '\n';
}

/// "v", "v/t", "v//n" or "v/t/n"; vt and vn are written one per wedge and share its number.
void append_corner(std::string& out, Index vertex, Index wedge, bool texcoords, bool normals) {
  out += ' ';
  append_number(out, std::uint64_t{vertex} + 1);
  if (!texcoords && !normals) return;
  out += '/';
  if (texcoords) append_number(out, std::uint64_t{wedge} + 1);
  if (!normals) return;
  out += '/';
  append_number(out, std::uint64_t{wedge} + 1);
}

}  // namespace

std::vector<std::byte> to_obj(const Mesh& mesh) {
  const Attribute* texcoords = find_float_attribute(mesh, "TEXCOORD_0", 2);
  const Attribute* normals = find_float_attribute(mesh, "NORMAL", 3);
  std::string out = "# lodestone\n";
  for (const Vec3f& p : mesh.positions) append_line(out, "v", {p.x, p.y, p.z});
  for (std::size_t w = 0; texcoords != nullptr && w < mesh.wedge_count(); ++w)
    append_line(out, "vt", {load_f32(texcoords->data, 8 * w), 1 - load_f32(texcoords->data, 8 * w + 4)});
  for (std::size_t w = 0; normals != nullptr && w < mesh.wedge_count(); ++w)
    append_line(
        out, "vn",
        {load_f32(normals->data, 12 * w), load_f32(normals->data, 12 * w + 4), load_f32(normals->data, 12 * w + 8)});
  Index material = 0;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (mesh.material_of(face) != material) {
      material = mesh.material_of(face);
      out += "usemtl material_";
      append_number(out, material);
      out += '\n';
    }
    out += 'f';
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner)
      append_corner(out, mesh.corner_vertex(corner), mesh.corner_wedge[corner], texcoords != nullptr,
                    normals != nullptr);
    out += '\n';
  }
  const auto bytes = std::as_bytes(std::span(out));
  return {bytes.begin(), bytes.end()};
}

const Attribute* find_float_attribute(const Mesh& mesh, const char* name, int component_count) {
  const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [&](const Attribute& a) {
    return a.name == name && a.type == ComponentType::Float32 && a.component_count == component_count;
  });
  return found == mesh.attributes.end() ? nullptr : &*found;
}

}  // namespace lodestone::detail

#include <algorithm>
#include <span>
#include <string>

#include <lodestone/core/detail/text.h>

#include "base/bytes.h"
#include "mesh/mesh_writers.h"
#include "mesh/vertex_color.h"

namespace lodestone::detail {
namespace {

/// The attributes PLY has common names for.
struct PlyAttributes {
  const Attribute* normals = nullptr;
  const Attribute* texcoords = nullptr;
  std::vector<float> colors;  ///< linear, `color_components` for each wedge
  std::size_t color_components = 0;

  bool any() const { return normals != nullptr || texcoords != nullptr || color_components > 0; }
};

PlyAttributes find_attributes(const Mesh& mesh) {
  PlyAttributes found{find_float_attribute(mesh, "NORMAL", 3), find_float_attribute(mesh, "TEXCOORD_0", 2), {}, 0};
  for (const Attribute& a : mesh.attributes) {
    if (a.name != "COLOR_0" || a.component_count < 3 || a.component_count > 4) continue;
    found.colors = attribute_values(a);
    found.color_components = a.component_count;
  }
  return found;
}

std::string header(std::size_t point_count, std::size_t face_count, const PlyAttributes& attributes) {
  std::string out = text("ply\nformat binary_little_endian 1.0\ncomment lodestone\nelement vertex ", point_count, '\n');
  const auto properties = [&](const char* type, std::initializer_list<const char*> names) {
    for (const char* name : names) out += text("property ", type, ' ', name, '\n');
  };
  properties("float", {"x", "y", "z"});
  if (attributes.normals != nullptr) properties("float", {"nx", "ny", "nz"});
  if (attributes.texcoords != nullptr) properties("float", {"s", "t"});
  if (attributes.color_components > 0) properties("uchar", {"red", "green", "blue"});
  if (attributes.color_components == 4) properties("uchar", {"alpha"});
  return out + text("element face ", face_count, "\nproperty list uchar uint vertex_indices\nend_header\n");
}

void append_element(std::vector<std::byte>& out, const Attribute& attribute, std::size_t wedge) {
  append_bytes(out, std::span(attribute.data).subspan(wedge * attribute.element_bytes(), attribute.element_bytes()));
}

/// PLY's colours are bytes of sRGB.
void append_color(std::vector<std::byte>& out, const PlyAttributes& attributes, std::size_t wedge) {
  for (std::size_t i = 0; i < attributes.color_components; ++i) {
    const float value = attributes.colors[wedge * attributes.color_components + i];
    append(out, i == 3 ? share_byte(value) : srgb_byte(value));
  }
}

void append_wedge(std::vector<std::byte>& out, const Mesh& mesh, const PlyAttributes& attributes, std::size_t wedge) {
  append(out, mesh.positions[mesh.wedge_vertex[wedge]]);
  if (attributes.normals != nullptr) append_element(out, *attributes.normals, wedge);
  if (attributes.texcoords != nullptr) {
    append(out, load_f32(attributes.texcoords->data, 8 * wedge));
    append(out, 1 - load_f32(attributes.texcoords->data, 8 * wedge + 4));  // PLY's t points up.
  }
  append_color(out, attributes, wedge);
}

}  // namespace

std::vector<std::byte> to_ply(const Mesh& mesh) {
  const PlyAttributes attributes = find_attributes(mesh);
  const std::size_t point_count = attributes.any() ? mesh.wedge_count() : mesh.vertex_count();
  const std::string text_header = header(point_count, mesh.face_count(), attributes);
  std::vector<std::byte> out;
  append_bytes(out, std::as_bytes(std::span(text_header)));
  for (std::size_t i = 0; i < point_count; ++i) {
    if (attributes.any())
      append_wedge(out, mesh, attributes, i);
    else
      append(out, mesh.positions[i]);
  }
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner) {
    if (corner % 3 == 0) append(out, std::uint8_t{3});
    append(out, attributes.any() ? mesh.corner_wedge[corner] : mesh.corner_vertex(corner));
  }
  return out;
}

}  // namespace lodestone::detail

#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/parallel.h>

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

/// Names a face's material, unless it is that of the face before it.
void append_material(std::string& out, const Mesh& mesh, Index face) {
  const Index material = mesh.material_of(face);
  if (material == (face == 0 ? 0 : mesh.material_of(face - 1))) return;
  out += "usemtl material_";
  append_number(out, material);
  out += '\n';
}

/// Adds the lines 0 … count − 1 as `append_one(lines, i)` makes them, many at a time side by side.
template <class AppendOne>
void add_lines(std::vector<std::string>& parts, std::size_t count, const AppendOne& append_one) {
  constexpr std::size_t kTogether = 1 << 14;
  const std::size_t first = parts.size();
  parts.resize(first + (count + kTogether - 1) / kTogether);
  for_each_chunk(count, kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) append_one(parts[first + begin / kTogether], i);
  });
}

std::vector<std::byte> joined(const std::vector<std::string>& parts) {
  std::size_t size = 0;
  for (const std::string& part : parts) size += part.size();
  std::vector<std::byte> out;
  out.reserve(size);
  for (const std::string& part : parts) append_bytes(out, std::as_bytes(std::span(part)));
  return out;
}

}  // namespace

std::vector<std::byte> to_obj(const Mesh& mesh) {
  const Attribute* texcoords = find_float_attribute(mesh, "TEXCOORD_0", 2);
  const Attribute* normals = find_float_attribute(mesh, "NORMAL", 3);
  std::vector<std::string> parts = {"# lodestone\n"};
  add_lines(parts, mesh.vertex_count(), [&](std::string& lines, std::size_t v) {
    const Vec3f& p = mesh.positions[v];
    append_line(lines, "v", {p.x, p.y, p.z});
  });
  add_lines(parts, texcoords != nullptr ? mesh.wedge_count() : 0, [&](std::string& lines, std::size_t w) {
    append_line(lines, "vt", {load_f32(texcoords->data, 8 * w), 1 - load_f32(texcoords->data, 8 * w + 4)});
  });
  add_lines(parts, normals != nullptr ? mesh.wedge_count() : 0, [&](std::string& lines, std::size_t w) {
    const auto n = load<Vec3f>(normals->data, sizeof(Vec3f) * w);
    append_line(lines, "vn", {n.x, n.y, n.z});
  });
  add_lines(parts, mesh.face_count(), [&](std::string& lines, std::size_t f) {
    const auto face = static_cast<Index>(f);
    append_material(lines, mesh, face);
    lines += 'f';
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner)
      append_corner(lines, mesh.corner_vertex(corner), mesh.corner_wedge[corner], texcoords != nullptr,
                    normals != nullptr);
    lines += '\n';
  });
  return joined(parts);
}

const Attribute* find_float_attribute(const Mesh& mesh, const char* name, int component_count) {
  const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [&](const Attribute& a) {
    return a.name == name && a.type == ComponentType::Float32 && a.component_count == component_count;
  });
  return found == mesh.attributes.end() ? nullptr : &*found;
}

}  // namespace lodestone::detail

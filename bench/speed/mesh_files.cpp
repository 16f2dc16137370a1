#include "mesh_files.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>

#include <lodestone/io/write_mesh.h>

#include "mesh/soup_file.h"

namespace lodestone::bench {
namespace {

/// Text that grows by numbers and words.
class Text {
 public:
  Text& operator<<(const char* words) {
    out_ += words;
    return *this;
  }
  template <class T>
  Text& operator<<(T number) {
    std::array<char, 32> digits;
    out_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
    return *this;
  }
  Text& operator<<(const Vec3f& p) { return *this << p.x << " " << p.y << " " << p.z; }

  std::vector<std::byte> bytes() const {
    const auto bytes = std::as_bytes(std::span(out_));
    return {bytes.begin(), bytes.end()};
  }

 private:
  std::string out_;
};

void add_vertices_and_faces(const Mesh& mesh, Text& out) {
  for (const Vec3f& p : mesh.positions) out << p << "\n";
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner)
    out << (corner % 3 == 0 ? "3 " : " ") << mesh.corner_vertex(corner) << (corner % 3 == 2 ? "\n" : "");
}

std::vector<std::byte> off_bytes(const Mesh& mesh) {
  Text out;
  out << "OFF\n" << mesh.vertex_count() << " " << mesh.face_count() << " 0\n";
  add_vertices_and_faces(mesh, out);
  return out.bytes();
}

std::vector<std::byte> ascii_ply_bytes(const Mesh& mesh) {
  Text out;
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertex_count()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.face_count()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  add_vertices_and_faces(mesh, out);
  return out.bytes();
}

std::vector<std::byte> ascii_stl_bytes(const Mesh& mesh) {
  Text out;
  out << "solid torus\n";
  for (Index face = 0; face < mesh.face_count(); ++face) {
    out << "  facet normal 0 0 0\n    outer loop\n";
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner)
      out << "      vertex " << mesh.positions[mesh.corner_vertex(corner)] << "\n";
    out << "    endloop\n  endfacet\n";
  }
  out << "endsolid\n";
  return out.bytes();
}

std::vector<std::byte> stl_bytes(const Mesh& mesh) {
  constexpr std::size_t kHeader = 84, kTriangle = 50, kNormal = 12;
  std::vector<std::byte> out(kHeader + kTriangle * mesh.face_count());
  const auto count = static_cast<std::uint32_t>(mesh.face_count());
  std::memcpy(&out[kHeader - sizeof count], &count, sizeof count);
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner)
    std::memcpy(&out[kHeader + kTriangle * (corner / 3) + kNormal + sizeof(Vec3f) * (corner % 3)],
                &mesh.positions[mesh.corner_vertex(corner)], sizeof(Vec3f));
  return out;
}

}  // namespace

std::vector<std::byte> file_bytes(const Mesh& mesh, const std::string& format) {
  if (format == "off") return off_bytes(mesh);
  if (format == "ply-ascii") return ascii_ply_bytes(mesh);
  if (format == "stl-ascii") return ascii_stl_bytes(mesh);
  if (format == "stl") return stl_bytes(mesh);
  return *write_mesh_bytes(mesh, "mesh." + format);
}

Mesh with_attributes(const Mesh& mesh) {
  std::vector<float> normals, texcoords;
  for (const Index vertex : mesh.wedge_vertex) {
    const Vec3 normal = normalized(Vec3(mesh.positions[vertex]));
    for (const double component : {normal.x, normal.y, normal.z}) normals.push_back(static_cast<float>(component));
    texcoords.push_back(static_cast<float>(std::abs(normal.x)));
    texcoords.push_back(static_cast<float>(std::abs(normal.y)));
  }
  Mesh out = mesh;
  out.attributes = {detail::float_attribute("NORMAL", 3, normals), detail::float_attribute("TEXCOORD_0", 2, texcoords)};
  return out;
}

}  // namespace lodestone::bench

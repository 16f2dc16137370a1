#include "golden/compact_files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <sstream>
#include <utility>

#include <lodestone/core/assemble.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/placed_shapes.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using Bytes = std::vector<std::byte>;

ProgressiveMesh simplified(const TriangleSoup& soup, bool vanish = false) {
  SimplifyOptions options;
  options.dense_rounds = 1.5;
  options.vanish = vanish;
  return simplify(assemble(soup).value().mesh, options).value().mesh;
}

Bytes encoded(CompactCoding coding, const ProgressiveMesh& mesh, int grid_bits,
              std::span<const PlacedLevel> levels = {}) {
  CompactOptions options;
  options.coding = coding;
  options.grid_bits = grid_bits;
  options.normal_bits = 8;
  return encode_compact(mesh, options, levels).value().bytes;
}

Attribute floats(std::string name, std::uint8_t component_count, const std::vector<float>& values) {
  Attribute attribute{std::move(name), ComponentType::Float32, component_count, false, {}};
  attribute.data.resize(values.size() * sizeof(float));
  std::memcpy(attribute.data.data(), values.data(), attribute.data.size());
  return attribute;
}

/// A sphere with a seam, its normals and texture coordinates, and tangents that are mirrored on one half.
TriangleSoup tangent_sphere(int m, int n) {
  TriangleSoup soup = seam_sphere(m, n);
  std::vector<float> tangents;
  for (const Vec3f& p : soup.positions) {
    const float length = std::sqrt(p.x * p.x + p.y * p.y);
    const bool pole = length < 1e-3F;
    tangents.insert(tangents.end(), {pole ? 1 : -p.y / length, pole ? 0 : p.x / length, 0, p.z > 0.3F ? -1.0F : 1.0F});
  }
  soup.attributes.push_back(floats("TANGENT", 4, tangents));
  return soup;
}

/// A skinned tube with two sets of weights, and numbers of every type.
TriangleSoup skinned_tube(int m, int n) {
  TriangleSoup soup = skinned_cylinder(m, n);
  soup.attributes.clear();
  std::array<Attribute, 2> joints{Attribute{"JOINTS_0", ComponentType::UInt8, 4, false, {}},
                                  Attribute{"JOINTS_1", ComponentType::UInt16, 4, false, {}}};
  std::array<std::vector<float>, 2> weights;
  const auto add = [&](std::size_t set, std::array<std::uint8_t, 4> names, std::array<float, 4> shares) {
    for (const std::uint8_t name : names) {
      joints[set].data.push_back(std::byte{name});
      if (set == 1) joints[set].data.push_back(std::byte{0});
    }
    weights[set].insert(weights[set].end(), shares.begin(), shares.end());
  };
  for (const Vec3f& p : soup.positions) {
    const float along = std::clamp(1.5F * p.z, 0.0F, 1.0F), aside = std::clamp(p.x, 0.0F, 0.25F);
    add(0, {0, 1, 2, 0}, {(1 - aside) * (1 - along), (1 - aside) * along, aside / 2, 0});
    add(1, {3, 4, 0, 0}, {aside / 2, 0, 0, 0});
  }
  soup.attributes = {joints[0], floats("WEIGHTS_0", 4, weights[0]), joints[1], floats("WEIGHTS_1", 4, weights[1])};
  const Attribute integers[] = {{"COLOR_0", ComponentType::UInt8, 3, true, {}},
                                {"TEXCOORD_0", ComponentType::UInt16, 2, true, {}},
                                {"_INT8", ComponentType::Int8, 1, false, {}},
                                {"_INT16", ComponentType::Int16, 1, true, {}},
                                {"_UINT32", ComponentType::UInt32, 1, false, {}}};
  for (Attribute attribute : integers) {
    for (const Vec3f& p : soup.positions)
      for (int c = 0; c < int{attribute.component_count}; ++c) {
        const auto value = static_cast<std::int32_t>(100 * p.z * static_cast<float>(c + 1)) * (c == 1 ? -1 : 1);
        for (std::size_t b = 0; b < component_bytes(attribute.type); ++b)
          attribute.data.push_back(static_cast<std::byte>(value >> (8 * b)));
      }
    soup.attributes.push_back(std::move(attribute));
  }
  std::vector<float> heights;
  for (const Vec3f& p : soup.positions) heights.push_back(p.z * p.z);
  soup.attributes.push_back(floats("_HEIGHT", 1, heights));
  return soup;
}

/// Keeps floats as they are: one has zeros of both signs, infinities and what is no number.
Bytes lossless(CompactCoding coding, TriangleSoup soup) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float odd[] = {-0.0F, 0.0F, kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), 1e-40F, -3.5e30F};
  std::vector<float> values;
  for (std::size_t i = 0; i < soup.positions.size(); ++i) values.push_back(odd[i % std::size(odd)]);
  soup.attributes.push_back(floats("_ODD", 1, values));
  CompactOptions options;
  options.coding = coding;
  options.grid_bits = 10;
  options.lossless = true;
  return encode_compact(simplified(soup), options).value().bytes;
}

Bytes staged(CompactCoding coding, const TriangleSoup& soup, std::size_t count, int grid_bits, bool vanish = false) {
  const ProgressiveMesh mesh = simplified(soup, vanish);
  return encoded(coding, mesh, grid_bits, scattered_levels(mesh, count, 0.02, 0.02, 5));
}

// FNV-1a of 64 bits.
class Checksum {
 public:
  void add(std::byte byte) { sum_ = (sum_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001B3U; }
  void add(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) add(static_cast<std::byte>(value >> shift));
  }
  void add(float value) { add(std::bit_cast<std::uint32_t>(value)); }
  std::string text() const {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text(16, '0');
    for (std::size_t i = 0; i < 16; ++i) text[i] = kDigits[sum_ >> (60 - 4 * i) & 15U];
    return text;
  }

 private:
  std::uint64_t sum_ = 0xCBF29CE484222325U;
};

std::string positions_of(const Mesh& level) {
  Checksum sum;
  for (const Vec3f& p : level.positions)
    for (const float x : {p.x, p.y, p.z}) sum.add(x);
  return sum.text();
}

/// Faces group by group, each group's sorted or in the order of their slots.
std::string faces_of(const ProgressiveMesh& mesh, const Cursor& cursor, bool sorted) {
  Checksum sum;
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    const std::span<const Index> corners = cursor.corners(g);
    std::vector<std::array<Index, 3>> faces(corners.size() / 3);
    for (std::size_t c = 0; c < corners.size(); ++c) faces[c / 3][c % 3] = corners[c];
    if (sorted) std::sort(faces.begin(), faces.end());
    sum.add(static_cast<std::uint32_t>(faces.size()));
    for (const auto& face : faces)
      for (const Index wedge : face) sum.add(wedge);
  }
  return sum.text();
}

std::string errors_of(const ProgressiveMesh& mesh) {
  Checksum sum;
  for (std::size_t p = 0; p <= mesh.record_count(); ++p) {
    sum.add(mesh.deviation[p]);
    sum.add(mesh.curvature_error[p]);
  }
  return sum.text();
}

std::string line_of(const ProgressiveMesh& mesh, std::size_t chunk) {
  Cursor cursor(mesh);
  cursor.seek(static_cast<Index>(mesh.record_count()));
  const Mesh level = extract_level(mesh, cursor);
  Checksum wedges;
  for (const Index vertex : level.wedge_vertex) wedges.add(vertex);
  std::ostringstream out;
  out << "chunk " << chunk << " rounds " << mesh.round_begin.size() - 1 << " vertices " << level.positions.size()
      << " wedges " << level.wedge_vertex.size() << " faces " << cursor.face_count() << " positions "
      << positions_of(level) << " wedges " << wedges.text() << " faces " << faces_of(mesh, cursor, true) << " slots "
      << faces_of(mesh, cursor, false) << " errors " << errors_of(mesh);
  for (const Attribute& attribute : level.attributes) {
    Checksum sum;
    for (const std::byte byte : attribute.data) sum.add(byte);
    out << ' ' << attribute.name << ' ' << sum.text();
  }
  return out.str();
}

}  // namespace

std::vector<CompactFile> compact_files() {
  using Encode = Bytes (*)(CompactCoding);
  struct Shape {
    std::string name, what;
    Encode encode;
  };
  const std::vector<Shape> shapes = {
      {"triangle", "a base of one triangle, and one vertex inside it",
       [](CompactCoding coding) { return encoded(coding, simplified(fan(3, 0.4)), 8); }},
      {"closed", "closed patches, two chunks",
       [](CompactCoding coding) { return encoded(coding, simplified(icosphere(3, 0.05, 4)), 12); }},
      {"border", "borders: open patches and ears",
       [](CompactCoding coding) { return encoded(coding, simplified(terrain(16, 7)), 12); }},
      {"groups", "groups with seams between them; joined patches of two sheets",
       [](CompactCoding coding) { return encoded(coding, simplified(layered(slit_grid(8), 2)), 11); }},
      {"seams", "normals and texture coordinates, several wedges at a vertex, moved sectors",
       [](CompactCoding coding) { return encoded(coding, simplified(seam_cube(5)), 10); }},
      {"tangents", "a seam, tangents that are mirrored on one half",
       [](CompactCoding coding) { return encoded(coding, simplified(tangent_sphere(10, 8)), 11); }},
      {"skin", "two sets of joints and weights, integers of every type",
       [](CompactCoding coding) { return encoded(coding, simplified(skinned_tube(8, 10)), 11); }},
      {"pieces", "loose records: pieces that come into being, wedges that no face uses yet",
       [](CompactCoding coding) { return encoded(coding, simplified(many_components(3), true), 10); }},
      {"sheets", "edges of many faces: loose records within what is there",
       [](CompactCoding coding) { return encoded(coding, simplified(random_squares(4, 3), true), 10); }},
      {"stages", "four stages: moves, and grids that get finer",
       [](CompactCoding coding) { return staged(coding, terrain(13, 6), 3, 12); }},
      {"staged-pieces", "moves of vertices without faces",
       [](CompactCoding coding) { return staged(coding, tetrahedron(), 2, 8, true); }},
      {"lossless", "floats bit for bit", [](CompactCoding coding) { return lossless(coding, tangent_sphere(7, 5)); }},
      {"vertex", "one vertex at a time from nothing to a tetrahedron",
       [](CompactCoding coding) { return encoded(coding, simplified(tetrahedron(), true), 8); }},
      {"empty", "no vertices", [](CompactCoding coding) { return encoded(coding, simplified(empty_soup()), 8); }},
  };
  std::vector<CompactFile> files;
  for (const CompactCoding coding : {CompactCoding::Small, CompactCoding::Fast})
    for (const Shape& shape : shapes)
      files.push_back({coding == CompactCoding::Small ? "compact-3.0" : "compact-3.1", shape.name, shape.what,
                       [coding, encode = shape.encode] { return encode(coding); }});
  return files;
}

std::string compact_heading(const CompactFile& file) { return "# " + file.what; }

std::vector<std::string> compact_levels(std::span<const std::byte> bytes) {
  const auto chunks = read_compact_chunks(bytes);
  if (!chunks) return {chunks.error().message};
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < chunks->size(); ++i) {
    const CompactChunk& chunk = (*chunks)[i];
    const auto mesh = decode_compact(bytes.first(static_cast<std::size_t>(chunk.byte_offset + chunk.byte_length)));
    lines.push_back(mesh ? line_of(*mesh, i) : mesh.error().message);
  }
  return lines;
}

}  // namespace lodestone::test

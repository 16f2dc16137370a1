// Faces are visited one neighbour after the other, as in J. Rossignac, "Edgebreaker: connectivity compression for
// triangle meshes", IEEE TVCG 5(1), 1999, but a vertex that was seen before is named by its number: simpler to undo,
// and any triangles will do. New vertices are predicted by the parallelogram rule (C. Touma, C. Gotsman, "Triangle mesh
// compression", 1998). Entropy coding is left to deflate, for which every browser has a decoder.
//
// Before deflate, all numbers little-endian:
//
//   u32 vertex count, u32 face count, u32 symbol bytes
//   symbols, LEB128 each: 0 a new vertex, 1 no face, k + 2 the vertex k + 1 before the next new one
//   six planes, a byte for each vertex: low bytes of x, y, z, high bytes of x, y, z, of the zigzagged difference
//   between the coordinate and its prediction, modulo 65536
//
// A face that none of those before it leads to begins with three symbols and is predicted by the last new vertex (at
// first 0, 0, 0). Its edges are then open; the one opened last is looked at first. Where the edge is not yet taken in
// the opposite direction, one symbol tells the third vertex of the face there, and that face opens its other two edges.

#include "page_geometry.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/edges.h>

namespace lodestone::tool {
namespace {

using detail::Compaction;
using detail::Edge;
using detail::for_each_edge;
using detail::HalfEdge;
using detail::sorted_edges;

using Grid = std::array<std::uint16_t, 3>;

void append_u32(std::vector<std::byte>& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

std::vector<std::byte> deflated(const std::vector<std::byte>& plain) {
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  std::vector<std::byte> out(size);
  const auto* from = reinterpret_cast<const Bytef*>(plain.data());
  auto* to = reinterpret_cast<Bytef*>(out.data());
  if (compress2(to, &size, from, static_cast<uLong>(plain.size()), Z_BEST_COMPRESSION) != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

Grid quantised(const Vec3f& position, const Box& box) {
  const auto cell = [](double x, double low, double high) {
    const double share = high > low ? std::clamp((x - low) / (high - low), 0.0, 1.0) : 0;
    return static_cast<std::uint16_t>(std::lround(65535 * share));
  };
  return {cell(position.x, box.low.x, box.high.x), cell(position.y, box.low.y, box.high.y),
          cell(position.z, box.low.z, box.high.z)};
}

class GeometryEncoder {
 public:
  GeometryEncoder(const Mesh& mesh, const Box& box) : mesh_(mesh), vertices_(mesh.vertex_count()) {
    for (const Vec3f& position : mesh.positions) grid_.push_back(quantised(position, box));
    name_edges();
  }

  PageGeometry encode() {
    std::vector<bool> done(mesh_.face_count());
    for (Index face = 0; face < mesh_.face_count(); ++face) {
      if (done[face]) continue;
      done[face] = true;
      begin_piece(face);
      while (!open_.empty()) step(done);
    }
    return {deflated(packed()), vertices_.used()};
  }

 private:
  Index vertex(Index corner) const { return mesh_.corner_vertex(corner); }

  /// Names each direction of an edge by the first corner that it leaves.
  void name_edges() {
    name_.resize(mesh_.corner_wedge.size());
    reverse_.resize(name_.size());
    taken_.resize(name_.size());
    const std::vector<HalfEdge> halves = sorted_edges(mesh_);
    for_each_edge(halves, [&](Edge edge) {
      std::array<Index, 2> first{kNoIndex, kNoIndex};  // by whether it is forward
      for (const HalfEdge& half : edge)
        if (Index& name = first[half.forward ? 1 : 0]; name == kNoIndex) name = half.corner;
      if (edge[0].is_loop()) first[1] = first[0];  // its own reverse
      for (const HalfEdge& half : edge) {
        name_[half.corner] = first[half.forward ? 1 : 0];
        reverse_[half.corner] = first[half.forward ? 0 : 1];
      }
    });
  }

  void begin_piece(Index face) {
    const Index a = vertex(3 * face), b = vertex(3 * face + 1), c = vertex(3 * face + 2);
    for (const Index v : {a, b, c}) put_vertex(v, vertices_.used().empty() ? Grid{} : grid_[vertices_.used().back()]);
    take_face(face);
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) open_.push_back(corner);
  }

  void step(std::vector<bool>& done) {
    const Index gate = open_.back();
    open_.pop_back();
    const Index found = reverse_[gate];
    if (found != kNoIndex && taken_[found]) return;
    if (found == kNoIndex || done[face_of_corner(found)]) return put_symbol(1);
    done[face_of_corner(found)] = true;
    Grid guess{};
    for (std::size_t i = 0; i < 3; ++i) {
      const int sum =
          grid_[vertex(gate)][i] + grid_[vertex(next_corner(gate))][i] - grid_[vertex(previous_corner(gate))][i];
      guess[i] = static_cast<std::uint16_t>(std::clamp(sum, 0, 65535));
    }
    put_vertex(vertex(previous_corner(found)), guess);
    take_face(face_of_corner(found));
    open_.push_back(previous_corner(found));
    open_.push_back(next_corner(found));
  }

  void take_face(Index face) {
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) taken_[name_[corner]] = true;
  }

  void put_vertex(Index v, const Grid& guess) {
    const auto count = static_cast<Index>(vertices_.used().size());
    const Index number = vertices_.add(v);
    if (number < count) return put_symbol(count - number + 1);
    put_symbol(0);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto difference = static_cast<std::int16_t>(static_cast<std::uint16_t>(grid_[v][i] - guess[i]));
      const auto zigzag = static_cast<std::uint16_t>(difference < 0 ? -2 * difference - 1 : 2 * difference);
      planes_[i].push_back(static_cast<std::byte>(zigzag & 0xff));
      planes_[3 + i].push_back(static_cast<std::byte>(zigzag >> 8));
    }
  }

  void put_symbol(Index symbol) {
    for (; symbol >= 0x80; symbol >>= 7) symbols_.push_back(static_cast<std::byte>((symbol & 0x7f) | 0x80));
    symbols_.push_back(static_cast<std::byte>(symbol));
  }

  std::vector<std::byte> packed() const {
    std::vector<std::byte> out;
    append_u32(out, vertices_.used().size());
    append_u32(out, mesh_.face_count());
    append_u32(out, symbols_.size());
    out.insert(out.end(), symbols_.begin(), symbols_.end());
    for (const std::vector<std::byte>& plane : planes_) out.insert(out.end(), plane.begin(), plane.end());
    return out;
  }

  const Mesh& mesh_;
  std::vector<Grid> grid_;
  Compaction vertices_;
  std::vector<Index> name_;     // by corner: the first one that leaves its edge the same way
  std::vector<Index> reverse_;  // the same: the other way
  std::vector<bool> taken_;     // by name: whether a face has it
  std::vector<Index> open_;     // the edges of faces that are there, by corner
  std::vector<std::byte> symbols_;
  std::array<std::vector<std::byte>, 6> planes_;
};

}  // namespace

PageGeometry encode_geometry(const Mesh& mesh, const Box& box) { return GeometryEncoder(mesh, box).encode(); }

std::vector<std::byte> encode_errors(std::span<const float> errors, double maximum, std::span<const Index> vertices) {
  std::vector<std::byte> plain;
  unsigned last = 0;
  for (const Index v : vertices) {
    const double share = maximum > 0 ? std::clamp(errors[v] / maximum, 0.0, 1.0) : 0;
    const auto value = static_cast<unsigned>(std::lround(255 * std::sqrt(share)));
    plain.push_back(static_cast<std::byte>((value - last) & 0xff));
    last = value;
  }
  return deflated(plain);
}

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? std::to_integer<unsigned>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace lodestone::tool

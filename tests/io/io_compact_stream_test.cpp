#include <lodestone/io/compact_stream.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <string>

#include <lodestone/core/parallel.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

using Face = std::array<Index, 3>;

ProgressiveMesh progressive(const Mesh& mesh, double dense_rounds) {
  SimplifyOptions options;
  options.dense_rounds = dense_rounds;
  auto result = simplify(mesh, options);
  REQUIRE(result);
  return std::move(result->mesh);
}

ProgressiveMesh progressive(const TriangleSoup& soup, double dense_rounds = 1.5) {
  return progressive(mesh_of(soup), dense_rounds);
}

CompactStream encoded(const ProgressiveMesh& mesh, int grid_bits = 12) {
  CompactOptions options;
  options.grid_bits = grid_bits;
  auto stream = encode_compact(mesh, options);
  INFO((stream ? std::string() : stream.error().message));
  REQUIRE(stream);
  return std::move(*stream);
}

ProgressiveMesh decoded(std::span<const std::byte> bytes) {
  auto mesh = decode_compact(bytes);
  INFO((mesh ? std::string() : mesh.error().message));
  REQUIRE(mesh);
  const auto valid = validate(*mesh);
  INFO((valid ? std::string() : valid.error().message));
  REQUIRE(valid);
  return std::move(*mesh);
}

/// A level's faces by their vertices, numbered anew; each begins with its least.
std::multiset<Face> faces_at(const ProgressiveMesh& mesh, Index position, const std::vector<Index>& numbers) {
  Cursor cursor(mesh);
  cursor.seek(position);
  std::multiset<Face> faces;
  const auto corners = cursor.corners(0);
  for (std::size_t c = 0; c < corners.size(); c += 3) {
    Face face;
    for (std::size_t k = 0; k < 3; ++k) face[k] = numbers[mesh.wedge_vertex[corners[c + k]]];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.insert(face);
  }
  return faces;
}

std::vector<Index> same_numbers(const ProgressiveMesh& mesh) {
  std::vector<Index> numbers(mesh.positions.size());
  for (Index i = 0; i < numbers.size(); ++i) numbers[i] = i;
  return numbers;
}

/// The grid that positions are rounded to where nobody gives one: its step, and the farthest that one is moved.
struct Grid {
  double step = 0;
  double reach() const { return std::sqrt(3.0) / 2 * step * 1.0001; }
};

Grid grid_of(const ProgressiveMesh& mesh, int bits) {
  std::array<double, 3> low{}, high{};
  low.fill(HUGE_VAL);
  high.fill(-HUGE_VAL);
  for (const Vec3f& p : mesh.positions) {
    const std::array<float, 3> values = {p.x, p.y, p.z};
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], static_cast<double>(values[c]));
      high[c] = std::max(high[c], static_cast<double>(values[c]));
    }
  }
  const double range = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  return {range / ((1 << bits) - 1)};
}

/// Checks a decoded mesh against what was encoded: the finest mesh, and the level after every round.
void check_same(const ProgressiveMesh& mesh, const CompactStream& stream, const ProgressiveMesh& coded, int bits) {
  REQUIRE(coded.positions.size() == mesh.positions.size());
  REQUIRE(coded.record_count() == mesh.record_count());
  REQUIRE(std::set<Index>(stream.vertex_numbers.begin(), stream.vertex_numbers.end()).size() == mesh.positions.size());
  const Grid grid = grid_of(mesh, bits);
  double farthest = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    farthest = std::max(farthest, length(Vec3(mesh.positions[v]) - Vec3(coded.positions[stream.vertex_numbers[v]])));
  CHECK(farthest <= grid.reach() + 1e-6);
  CHECK(coded.round_begin.size() == stream.round_count + 1);
  // Measured bounds may be lower at coarser levels; those of a stream never are.
  std::vector<float> largest = mesh.deviation;
  for (std::size_t i = largest.size(); i-- > 1;) largest[i - 1] = std::max(largest[i - 1], largest[i]);
  for (std::size_t r = 0; r < coded.round_begin.size(); ++r) {
    const Index position = coded.round_begin[r];
    // Rounds are stretches of the records given, so that the levels between them are levels of that mesh.
    CHECK(faces_at(mesh, position, stream.vertex_numbers) == faces_at(coded, position, same_numbers(coded)));
    CHECK(coded.deviation[position] >= mesh.deviation[position]);
    CHECK(coded.curvature_error[position] >= mesh.curvature_error[position]);
    // Rounded up by an eighth of an octave, and by what the grid moves.
    const double widest = (static_cast<double>(largest[position]) + 2 * grid.reach()) * std::exp2(0.126);
    if (largest[position] > largest[0] * 1e-6F) CHECK(static_cast<double>(coded.deviation[position]) <= widest);
  }
  CHECK(coded.deviation.back() == 0);
}

std::vector<NamedShape> plain_shapes() {
  return {{"triangle", single_triangle(), true, {}},
          {"grid", grid(6, 0.1, 1), true, {}},
          {"flat grid", grid(8, 0, 1), true, {}},
          {"terrain", terrain(12, 3), true, {}},
          {"annulus", annulus(9, 3), true, {}},
          {"cylinder", cylinder(9, 4), true, {}},
          {"fan", fan(9, 0.5), true, {}},
          {"wide fan", fan(120, 0.5), true, {}},
          {"tetrahedron", tetrahedron(), true, {}},
          {"cube", cube(4), true, {}},
          {"sphere", icosphere(3, 0.05, 1), true, {}},
          {"torus", torus(12, 8), true, {}},
          {"double cone", double_cone(12), true, {}}};
}

}  // namespace

TEST_CASE("a compact stream decodes to the mesh it was made of, on the grid, and to its level after every round") {
  for (const NamedShape& shape : plain_shapes())
    for (const double dense_rounds : {0.0, 1.5, 100.0})
      for (const int bits : {8, 12, 16}) {
        INFO(shape.name << ", rounds of " << dense_rounds << ", " << bits << " bits");
        const ProgressiveMesh mesh = progressive(shape.soup, dense_rounds);
        const CompactStream stream = encoded(mesh, bits);
        check_same(mesh, stream, decoded(stream.bytes), bits);
      }
}

TEST_CASE("whatever has the records of a plain mesh can be encoded, and all else is refused by name") {
  int done = 0, refused = 0;
  for (const NamedShape& shape : all_shapes()) {
    if (shape.soup.positions.empty()) continue;
    INFO(shape.name);
    TriangleSoup soup = shape.soup;
    soup.attributes.clear();
    const ProgressiveMesh mesh = progressive(soup);
    const auto stream = encode_compact(mesh, {});
    if (stream) {
      check_same(mesh, *stream, decoded(stream->bytes), 14);
      ++done;
    } else {
      CHECK(stream.error().code == ErrorCode::Unsupported);
      CHECK(stream.error().message.starts_with("compact stream: "));
      ++refused;
    }
  }
  CHECK(done >= 20);
  CHECK(refused >= 1);
}

TEST_CASE("models cost what they are said to, and come back") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  // Bits for each vertex at 12-bit positions, the whole stream; a little more than what they take.
  struct Limit {
    const char* path;
    double bits;
  };
  for (const Limit& limit : {Limit{"mesh/cow.obj", 25.6}, Limit{"mesh/rocker-arm.obj", 20.7}}) {
    if (kReduced) continue;
    INFO(limit.path);
    const auto path = model(limit.path);
    REQUIRE(path);
    const auto file = read_mesh(*path);
    REQUIRE(file);
    TriangleSoup soup = to_soup(file->mesh);
    soup.attributes.clear();
    soup.face_material.clear();
    const ProgressiveMesh mesh = progressive(soup);
    const CompactStream stream = encoded(mesh);
    check_same(mesh, stream, decoded(stream.bytes), 12);
    CHECK(8.0 * static_cast<double>(stream.bytes.size()) / static_cast<double>(mesh.positions.size()) < limit.bits);
  }
}

TEST_CASE("the sizes of a compact stream's parts add up") {
  const CompactStream stream = encoded(progressive(icosphere(3, 0.05, 1)));
  const CompactSizes& s = stream.sizes;
  for (const double part : {s.header, s.base, s.places, s.positions, s.errors}) CHECK(part > 0);
  const double sum = s.header + s.base + s.places + s.positions + s.errors;
  CHECK(std::abs(sum - 8.0 * static_cast<double>(stream.bytes.size())) < 1e-6);
}

TEST_CASE("a compact stream depends on nothing but the mesh") {
  const Mesh mesh = mesh_of(icosphere(3, 0.05, 1));
  const std::vector<std::byte> bytes = encoded(progressive(mesh, 1.5)).bytes;
  CHECK(encoded(progressive(mesh, 1.5)).bytes == bytes);
  const Vec3f far = {1000, 0, 0};
  Mesh moved = mesh;
  for (Vec3f& p : moved.positions) p = {p.x + far.x, p.y, p.z};
  CHECK(encoded(progressive(moved, 1.5)).bytes != bytes);
}

TEST_CASE("a compact stream that ends with a chunk is the level it leads to, and any other cut is an error") {
  const ProgressiveMesh mesh = progressive(terrain(40, 3));
  const CompactStream stream = encoded(mesh);
  const auto chunks = read_compact_chunks(stream.bytes);
  REQUIRE(chunks);
  REQUIRE(chunks->size() >= 3);
  CHECK(read_compact_chunks(std::span(stream.bytes).first(chunks->front().byte_offset)));
  std::set<std::uint64_t> ends;
  for (const CompactChunk& chunk : *chunks) {
    const std::uint64_t end = chunk.byte_offset + chunk.byte_length;
    ends.insert(end);
    const ProgressiveMesh prefix = decoded(std::span(stream.bytes).first(end));
    CHECK(prefix.record_count() == chunk.record_begin + chunk.record_count);
    CHECK(prefix.positions.size() == chunk.vertex_count);
    CHECK(prefix.groups[0].face_count == chunk.face_count);
    CHECK(prefix.deviation.back() == chunk.deviation);
    const auto position = static_cast<Index>(prefix.record_count());
    CHECK(faces_at(prefix, position, same_numbers(prefix)) == faces_at(mesh, position, stream.vertex_numbers));
  }
  CHECK(*ends.rbegin() == stream.bytes.size());
  // Each decodes what it can, so not every one is tried.
  for (std::size_t size = 0; size < stream.bytes.size();
       size += ends.contains(size + 1) || ends.contains(size) ? 1 : 29) {
    const auto cut = decode_compact(std::span(stream.bytes).first(size));
    INFO(size);
    CHECK(cut.has_value() == ends.contains(size));
    if (!cut) {
      CHECK(cut.error().message.starts_with("compact stream: "));
      CHECK(cut.error().byte_offset);
    }
  }
}

TEST_CASE("a flipped bit anywhere in a compact stream is a named error, and so are bytes behind its end") {
  std::vector<std::byte> bytes = encoded(progressive(icosphere(2, 0.05, 1))).bytes;
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; bit += kReduced ? 3 : 1) {
      bytes[at] ^= std::byte{1} << bit;
      const auto mesh = decode_compact(bytes);
      INFO("byte " << at << ", bit " << bit);
      CHECK(!mesh);
      if (!mesh) CHECK(mesh.error().message.starts_with("compact stream: "));
      bytes[at] ^= std::byte{1} << bit;
    }
  CHECK(decode_compact(bytes));
  bytes.push_back({});
  CHECK(!decode_compact(bytes));
}

TEST_CASE("meshes on one grid meet where they met") {
  CompactOptions options;
  options.grid_bits = 10;
  options.grid = CompactGrid{{-1, -1, -1}, 3};
  const ProgressiveMesh left = progressive(grid(6, 0.1, 1));
  TriangleSoup beside = grid(6, 0.1, 1);
  for (Vec3f& p : beside.positions) p.x += 1;
  const ProgressiveMesh right = progressive(beside);
  const auto first = encode_compact(left, options), second = encode_compact(right, options);
  REQUIRE(first);
  REQUIRE(second);
  const double step = 3.0 / 1023;
  for (const CompactStream* stream : {&*first, &*second})
    for (const Vec3f& p : decoded(stream->bytes).positions)
      for (const float value : {p.x, p.y, p.z}) {
        const double steps = (static_cast<double>(value) + 1) / step;
        CHECK(std::abs(steps - std::round(steps)) < 1e-3);
      }
}

TEST_CASE("options of compact streams out of range are refused") {
  const ProgressiveMesh mesh = progressive(tetrahedron());
  for (const int bits : {0, 7, 17, 30}) {
    CompactOptions options;
    options.grid_bits = bits;
    const auto stream = encode_compact(mesh, options);
    REQUIRE(!stream);
    CHECK(stream.error().code == ErrorCode::InvalidArgument);
  }
  CompactOptions options;
  options.grid = CompactGrid{{0, 0, 0}, 0};
  CHECK(!encode_compact(mesh, options));
}

}  // namespace lodestone::test

// Compact streams that keep floats bit for bit.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/simplify.h>

#include "support/compact.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/progressive_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

CompactStream encoded(const ProgressiveMesh& mesh, int grid_bits = 12, CompactCoding coding = CompactCoding::Small) {
  CompactOptions options;
  options.coding = coding;
  options.grid_bits = grid_bits;
  options.lossless = true;
  return stream_of(mesh, options);
}

/// Checks that a mesh has the floats that it had, bit for bit, and bounds that are none the wider for a grid.
void check_bits(const ProgressiveMesh& mesh, const CompactStream& stream, const ProgressiveMesh& coded) {
  REQUIRE(coded.positions.size() == mesh.positions.size());
  std::size_t other = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f &given = mesh.positions[v], &found = coded.positions[stream.vertex_numbers[v]];
    other += std::memcmp(&given, &found, sizeof given) != 0 ? 1 : 0;
  }
  CHECK(other == 0);
  REQUIRE(coded.attributes.size() == mesh.attributes.size());
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
    INFO(mesh.attributes[a].name);
    const std::size_t size = mesh.attributes[a].element_bytes();
    other = 0;
    for (std::size_t w = 0; w < mesh.wedge_vertex.size(); ++w)
      other += std::memcmp(mesh.attributes[a].data.data() + w * size,
                           coded.attributes[a].data.data() + stream.wedge_numbers[w] * size, size) != 0
                   ? 1
                   : 0;
    CHECK(other == 0);
  }
  float largest = 0;
  for (const float deviation : mesh.deviation) largest = std::max(largest, deviation);
  CHECK(coded.deviation[0] >= largest);
  CHECK(coded.deviation[0] <= 1.1F * largest);
  CHECK(coded.deviation.back() == 0);
}

/// A bumpy sphere, with an attribute of any floats.
ProgressiveMesh sphere_with(const std::vector<float>& values) {
  TriangleSoup soup = icosphere(3, 0.05, 1);
  Attribute odd;
  odd.name = "_ODD";
  odd.type = ComponentType::Float32;
  odd.component_count = 1;
  odd.data.resize(soup.positions.size() * sizeof(float));
  for (std::size_t i = 0; i < soup.positions.size(); ++i)
    std::memcpy(odd.data.data() + i * sizeof(float), &values[i % values.size()], sizeof(float));
  soup.attributes.push_back(odd);
  return simplify(mesh_of(soup), {}).value().mesh;
}

}  // namespace

TEST_CASE("a lossless stream gives back every float of every shape, on whatever grid") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  for (const ProgressiveMesh& mesh : progressive_shapes())
    for (const int bits : {8, 12, 16}) {
      INFO(mesh.record_count() << " records, " << bits << " bits");
      const CompactStream stream = encoded(mesh, bits, coding);
      check_bits(mesh, stream, decoded(stream.bytes));
    }
}

TEST_CASE("floats may be any: infinities, what is no number, zeros of either sign, the least and the largest") {
  using Limits = std::numeric_limits<float>;
  const ProgressiveMesh mesh =
      sphere_with({0, -0.0F, 1, -1, Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), Limits::denorm_min(),
                   -Limits::denorm_min(), Limits::max(), Limits::lowest(), Limits::min(), 1e-20F, 3.5F});
  const CompactStream stream = encoded(mesh);
  check_bits(mesh, stream, decoded(stream.bytes));
}

TEST_CASE("positions may be of any size, and far from the origin") {
  for (const float size : {1e-30F, 1e-6F, 1.0F, 1e6F, 1e30F})
    for (const float away : {0.0F, 1.0F, 1000.0F}) {
      INFO("size " << size << ", away by " << away << " of it");
      TriangleSoup soup = icosphere(2, 0.05, 1);
      for (Vec3f& p : soup.positions) p = {(p.x + away) * size, p.y * size, (p.z - away) * size};
      SimplifyOptions options;
      options.measure_step = 0;
      const ProgressiveMesh mesh = simplify(mesh_of(soup), options).value().mesh;
      const CompactStream stream = encoded(mesh);
      check_bits(mesh, stream, decoded(stream.bytes));
    }
}

TEST_CASE("what lies on the grid costs next to nothing, and noise less than streams of version 2") {
  TriangleSoup noisy = icosphere(kReduced ? 3 : 4, 0.05, 1);
  TriangleSoup whole = noisy;
  for (Vec3f& p : whole.positions)
    p = {std::round(p.x * 4000 + 8000), std::round(p.y * 4000 + 8000), std::round(p.z * 4000 + 8000)};
  SimplifyOptions simplification;
  simplification.measure_step = 0;
  CompactOptions options;
  options.lossless = true;
  options.grid_bits = 14;
  const auto bits_of_rests = [&](const TriangleSoup& soup) {
    const ProgressiveMesh mesh = simplify(mesh_of(soup), simplification).value().mesh;
    const CompactStream stream = encode_compact(mesh, options).value();
    check_bits(mesh, stream, decoded(stream.bytes));
    return stream.sizes.rests / static_cast<double>(3 * mesh.positions.size());
  };
  CHECK(bits_of_rests(noisy) > 8);
  const ProgressiveMesh noise = simplify(mesh_of(noisy), simplification).value().mesh;
  CHECK(encoded(noise).bytes.size() < encode_stream(noise).value().size());
  options.grid = CompactGrid{{}, 16383};  // steps of 1
  CHECK(bits_of_rests(whole) < 0.3);
}

TEST_CASE("a lossless stream can be cut after each chunk, and each level is part of the mesh") {
  const ProgressiveMesh mesh = simplify(mesh_of(icosphere(4, 0.05, 1)), {}).value().mesh;
  const CompactStream stream = encoded(mesh);
  const auto chunks = read_compact_chunks(stream.bytes).value();
  REQUIRE(chunks.size() > 2);
  const ProgressiveMesh whole = decoded(stream.bytes);
  for (const CompactChunk& chunk : chunks) {
    const ProgressiveMesh part = decoded(std::span(stream.bytes).first(chunk.byte_offset + chunk.byte_length));
    REQUIRE(part.positions.size() == chunk.vertex_count);
    CHECK(std::memcmp(part.positions.data(), whole.positions.data(), part.positions.size() * sizeof(Vec3f)) == 0);
  }
}

TEST_CASE("a lossless stream places no levels") {
  const ProgressiveMesh mesh = simplify(mesh_of(icosphere(2, 0.05, 1)), {}).value().mesh;
  PlacedLevel level;
  level.position = 10;
  level.positions.assign(mesh.positions.begin(), mesh.positions.begin() + mesh.base_vertex_count + 10);
  CompactOptions options;
  options.lossless = true;
  const auto stream = encode_compact(mesh, options, std::array{level});
  REQUIRE(!stream);
  CHECK(stream.error().code == ErrorCode::InvalidArgument);
  CHECK_THAT(stream.error().message, contains("lossless"));
}

}  // namespace lodestone::test

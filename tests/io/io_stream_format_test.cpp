#include <lodestone/io/stream_format.h>

#include <string>

#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/same_mesh.h"

namespace lodestone::test {
namespace {

ProgressiveMesh progressive(const TriangleSoup& soup) {
  auto result = simplify(mesh_of(soup));
  REQUIRE(result);
  return std::move(result->mesh);
}

std::vector<std::byte> encoded(const ProgressiveMesh& mesh, std::size_t records_per_chunk = 4096) {
  StreamOptions options;
  options.records_per_chunk = records_per_chunk;
  auto bytes = encode_stream(mesh, options);
  INFO((bytes ? std::string() : bytes.error().message));
  REQUIRE(bytes);
  return std::move(*bytes);
}

ProgressiveMesh decoded(std::span<const std::byte> bytes) {
  auto mesh = decode_stream(bytes);
  INFO((mesh ? std::string() : mesh.error().message));
  REQUIRE(mesh);
  return std::move(*mesh);
}

}  // namespace

TEST_CASE("a stream decodes to the progressive mesh it was made of, bit for bit") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const ProgressiveMesh mesh = progressive(shape.soup);
    for (const std::size_t records_per_chunk : {1u, 100u, 1u << 30})
      CHECK(same(decoded(encoded(mesh, records_per_chunk)), mesh));
  }
}

TEST_CASE("models decode bit for bit, too") {
  for (const char* path : {"mesh/spot/spot_triangulated.obj", "gltf/chr_knight.glb", "mesh/cow.obj"}) {
    const auto found = model(path);
    if (!found || kReduced) continue;
    INFO(path);
    const auto file = read_mesh(*found);
    REQUIRE(file);
    auto result = simplify(file->mesh);
    REQUIRE(result);
    CHECK(same(decoded(encoded(result->mesh)), result->mesh));
  }
}

TEST_CASE("attributes of every type survive") {
  TriangleSoup soup = icosphere(2, 0.1, 3);
  std::uint8_t value = 0;
  for (const ComponentType type : {ComponentType::Int8, ComponentType::UInt8, ComponentType::Int16,
                                   ComponentType::UInt16, ComponentType::UInt32, ComponentType::Float32}) {
    Attribute attribute{"_A" + std::to_string(static_cast<int>(type)), type, 3, false, {}};
    for (std::size_t i = 0; i < soup.positions.size() * attribute.element_bytes(); ++i)
      attribute.data.push_back(static_cast<std::byte>(value = static_cast<std::uint8_t>(value * 5 + 17)));
    soup.attributes.push_back(std::move(attribute));
  }
  const ProgressiveMesh mesh = progressive(soup);
  CHECK(same(decoded(encoded(mesh)), mesh));
}

TEST_CASE("the directory covers the stream and its levels") {
  const ProgressiveMesh mesh = progressive(icosphere(3, 0.05, 1));
  const auto bytes = encoded(mesh, 50);
  const auto directory = read_stream_directory(bytes);
  REQUIRE(directory);
  CHECK(directory->version_major == 2);
  CHECK(directory->total_bytes == bytes.size());
  REQUIRE(directory->chunks.size() > 3);
  const std::vector<Index> faces = face_counts(mesh);
  std::uint64_t offset = directory->chunks[0].byte_offset;
  Index record = 0;
  for (const StreamChunk& chunk : directory->chunks) {
    CHECK(chunk.byte_offset == offset);
    CHECK(chunk.record_begin == record);
    offset += chunk.byte_length;
    record += chunk.record_count;
    CHECK(chunk.face_count == faces[record]);
    CHECK(chunk.vertex_count == mesh.base_vertex_count + record);
    CHECK(chunk.deviation == mesh.deviation[record]);
    CHECK(chunk.curvature_error == mesh.curvature_error[record]);
    // A chunk ends where a round does.
    CHECK(std::binary_search(mesh.round_begin.begin(), mesh.round_begin.end(), record));
  }
  CHECK(offset == bytes.size());
  CHECK(record == mesh.record_count());
  // It needs no more than its own bytes.
  CHECK(read_stream_directory(std::span(bytes).first(directory->chunks[0].byte_offset)));
}

TEST_CASE("a prefix of whole chunks is the level it leads to") {
  const ProgressiveMesh mesh = progressive(seam_sphere(16, 12));
  const auto bytes = encoded(mesh, 20);
  const auto directory = read_stream_directory(bytes);
  REQUIRE(directory);
  for (const StreamChunk& chunk : directory->chunks) {
    const ProgressiveMesh prefix = decoded(std::span(bytes).first(chunk.byte_offset + chunk.byte_length));
    CHECK(prefix.record_count() == chunk.record_begin + chunk.record_count);
    CHECK(prefix.deviation.back() == chunk.deviation);
    Cursor whole(mesh), part(prefix);
    whole.seek(static_cast<Index>(prefix.record_count()));
    part.seek(static_cast<Index>(prefix.record_count()));
    CHECK(triangle_set(extract_level(mesh, whole)) == triangle_set(extract_level(prefix, part)));
    CHECK(part.face_count() == chunk.face_count);
  }
}

TEST_CASE("every other truncation is an error that says where") {
  const auto bytes = encoded(progressive(seam_cube(3)), 10);
  const auto directory = read_stream_directory(bytes);
  REQUIRE(directory);
  std::set<std::size_t> chunk_ends;
  for (const StreamChunk& chunk : directory->chunks) chunk_ends.insert(chunk.byte_offset + chunk.byte_length);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto mesh = decode_stream(std::span(bytes).first(size));
    CHECK(mesh.has_value() == chunk_ends.contains(size));
    if (!mesh) CHECK(mesh.error().byte_offset.has_value());
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  const auto mesh = decode_stream(longer);
  REQUIRE_FALSE(mesh);
  CHECK_THAT(mesh.error().message, contains("1 bytes follow its end"));
}

TEST_CASE("every flipped bit is an error") {
  const auto bytes = encoded(progressive(seam_cube(2)), 10);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::vector<std::byte> broken = bytes;
      broken[i] ^= static_cast<std::byte>(1 << bit);
      const auto mesh = decode_stream(broken);
      REQUIRE_FALSE(mesh);
      CHECK_FALSE(mesh.error().message.empty());
    }
}

TEST_CASE("a newer major version is unsupported, by its number") {
  auto bytes = encoded(progressive(tetrahedron()));
  bytes[8] = std::byte{3};
  const auto mesh = decode_stream(bytes);
  REQUIRE_FALSE(mesh);
  CHECK(mesh.error().code == ErrorCode::Unsupported);
  CHECK_THAT(mesh.error().message, contains("version 3.0"));
}

TEST_CASE("the golden stream of version 1.0 still decodes to the same mesh") {
  // seam_sphere(12, 9), encoded when version 1.0 was fixed; never to be written again.
  const auto bytes = read_file(std::filesystem::path(LODESTONE_SOURCE_DIR) / "tests/golden/stream-1.0.lds");
  REQUIRE(bytes);
  const ProgressiveMesh mesh = decoded(*bytes);
  CHECK(mesh.vertex_count() == 98);
  CHECK(mesh.wedge_vertex.size() == 128);
  CHECK(mesh.record_count() == 73);
  CHECK(mesh.round_begin.size() == 61);
  CHECK(mesh.sectors.size() == 80);
  Cursor cursor(mesh);
  cursor.seek(73);
  CHECK(triangle_set(extract_level(mesh, cursor)) == triangle_set(mesh_of(seam_sphere(12, 9))));
}

TEST_CASE("invalid meshes and options are refused") {
  ProgressiveMesh mesh = progressive(icosphere(2, 0.1, 1));
  REQUIRE(mesh.record_count() > 0);
  StreamOptions options;
  options.zstd_level = 20;
  CHECK_FALSE(encode_stream(mesh, options));
  std::swap(mesh.polygons[0], mesh.polygons[1]);
  const auto bytes = encode_stream(mesh);
  REQUIRE_FALSE(bytes);
  CHECK_THAT(bytes.error().message, contains("record 0"));
}

TEST_CASE("regular meshes compress no further than a decoder may believe") {
  // Heights, deviations and rings of a flat grid are all alike.
  const ProgressiveMesh mesh = progressive(grid(kReduced ? 30 : 120, 0, 1));
  CHECK(same(decoded(encoded(mesh)), mesh));
}

}  // namespace lodestone::test

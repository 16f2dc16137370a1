#include <lodestone/io/asset.h>

#include <sys/resource.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>

#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

/// Levels of a shape in three resolutions.
std::vector<AssetLevel> sphere_levels() {
  std::vector<AssetLevel> levels(3);
  for (int i = 0; i < 3; ++i) {
    AssetLevel& level = levels[static_cast<std::size_t>(i)];
    level.mesh = mesh_of(icosphere(3 - i, 0, 1));
    level.deviation.forward.maximum = 0.01 * i;
    level.deviation.backward.mean = 0.001 * i;
    level.curvature_error = 0.1 * i;
    level.stop_reason = "faces";
  }
  return levels;
}

/// Levels number the primitives of their scene, where readers number materials.
Mesh numbered_by_primitive(Mesh mesh) {
  const Scene scene = Scene::from_mesh({std::move(mesh), {}, {}, {}, {}}, "").value();
  return scene.meshes()[0].mesh;
}

/// Encodes levels as those of a scene of one mesh, which the first of them describes.
Result<EncodedAsset> encode(std::span<const AssetLevel> levels, const AssetOptions& options,
                            std::size_t stream_bytes = 0) {
  const Scene scene = Scene::from_mesh({levels[0].mesh, {}, {}, {}, {}}, "thing").value();
  const LeveledMesh mesh{{levels.begin(), levels.end()}, std::vector<std::byte>(stream_bytes, std::byte{7})};
  return encode_scene(scene, std::span(&mesh, scene.meshes().size()), options);
}

EncodedAsset encoded(std::span<const AssetLevel> levels, const AssetOptions& options, std::size_t stream_bytes = 0) {
  auto asset = encode(levels, options, stream_bytes);
  INFO((asset ? std::string() : asset.error().message));
  REQUIRE(asset);
  return std::move(*asset);
}

std::vector<Asset::Level> decoded(const EncodedAsset& asset) {
  auto levels = Asset::read_bytes(asset.glb).and_then([](const Asset& read) { return read.levels(); });
  INFO((levels ? std::string() : levels.error().message));
  REQUIRE(levels);
  return std::move(*levels);
}

std::string json_of(const EncodedAsset& asset) {
  std::uint32_t size = 0;
  std::memcpy(&size, asset.glb.data() + 12, sizeof size);
  return {reinterpret_cast<const char*>(asset.glb.data()) + 20, size};
}

/// The largest distance of a vertex to the vertex of the other mesh nearest to it.
double farthest_vertex(const Mesh& a, const Mesh& b, double beyond = 1e9) {
  double farthest = 0;
  for (const Vec3f& p : a.positions) {
    double nearest = beyond;
    for (const Vec3f& q : b.positions) nearest = std::min(nearest, length(Vec3(p) - Vec3(q)));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

/// The most memory that this process has had.
long peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// The values of a mesh's one attribute, by where they are.
std::map<std::array<float, 3>, std::vector<float>> values_at_places(const Mesh& mesh) {
  REQUIRE(mesh.attributes.size() == 1);
  const std::vector<float> values = attribute_values(mesh.attributes[0]);
  const std::size_t width = mesh.attributes[0].component_count;
  std::map<std::array<float, 3>, std::vector<float>> by_place;
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w) {
    const Vec3f& p = mesh.positions[mesh.wedge_vertex[w]];
    by_place[{p.x, p.y, p.z}] = {values.begin() + static_cast<std::ptrdiff_t>(w * width),
                                 values.begin() + static_cast<std::ptrdiff_t>((w + 1) * width)};
  }
  return by_place;
}

}  // namespace

TEST_CASE("plain levels read back bit for bit, with their numbers") {
  AssetOptions options;
  options.compression = Compression::None;
  const auto levels = sphere_levels();
  const EncodedAsset encoding = encoded(levels, options, 99);
  const auto read = decoded(encoding);
  REQUIRE(read.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    Mesh mesh = read[i].mesh;
    mesh.face_material.clear();  // coarser levels have materials of their own
    CHECK(triangle_set(mesh) == triangle_set(levels[i].mesh));
    CHECK(read[i].maximum_deviation == levels[i].deviation.maximum());
    CHECK(read[i].mean_deviation == levels[i].deviation.backward.mean);
    CHECK(read[i].curvature_error == levels[i].curvature_error);
    CHECK_FALSE(read[i].compression == Compression::Draco);
  }
  const auto streams = Asset::read_bytes(encoding.glb).value().streams().value();
  REQUIRE(streams.size() == 1);
  CHECK(streams[0].mesh == "thing");
  CHECK(streams[0].bytes == std::vector<std::byte>(99, std::byte{7}));
}

TEST_CASE("compressed levels keep their faces and move no vertex farther than half a step") {
  const Compression compression = GENERATE(Compression::Draco, Compression::Meshopt);
  for (const int bits : {8, 14, 20}) {
    AssetOptions options;
    options.compression = compression;
    options.position_bits = bits;
    const auto levels = sphere_levels();
    const auto read = decoded(encoded(levels, options));
    REQUIRE(read.size() == 3);
    const double step = 2.0 / (std::pow(2.0, bits) - 1);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(read[i].compression == compression);
      CHECK(read[i].mesh.face_count() == levels[i].mesh.face_count());
      CHECK(farthest_vertex(levels[i].mesh, read[i].mesh) <= 0.51 * step * std::sqrt(3.0) + 1e-6);
    }
  }
}

TEST_CASE("levels share one grid: a vertex of two levels is at one place") {
  const Compression compression = GENERATE(Compression::Draco, Compression::Meshopt);
  AssetOptions options;
  options.compression = compression;
  options.position_bits = 10;
  const auto read = decoded(encoded(sphere_levels(), options));
  // A subdivided icosphere keeps the vertices of the coarser one.
  CHECK(farthest_vertex(read[2].mesh, read[0].mesh) == 0);
}

TEST_CASE("attributes and materials survive, plain exactly, draco in number") {
  for (const TriangleSoup& soup : {seam_cube(3), seam_sphere(8, 6), two_material_grid(4)}) {
    std::vector<AssetLevel> levels(1);
    levels[0].mesh = numbered_by_primitive(mesh_of(soup));
    for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
      AssetOptions options;
      options.compression = compression;
      const auto read = decoded(encoded(levels, options));
      const Mesh& mesh = read.at(0).mesh;
      CHECK(mesh.face_count() == levels[0].mesh.face_count());
      CHECK(mesh.wedge_count() == levels[0].mesh.wedge_count());
      CHECK(mesh.attributes.size() == levels[0].mesh.attributes.size());
      CHECK(std::set<Index>(mesh.face_material.begin(), mesh.face_material.end()).size() ==
            std::set<Index>(levels[0].mesh.face_material.begin(), levels[0].mesh.face_material.end()).size());
    }
  }
}

TEST_CASE("compression holds shapes of any size") {
  const Compression compression = GENERATE(Compression::Draco, Compression::Meshopt);
  for (const double size : {1e-30, 1e-9, 1e-6, 1e-3, 1e4, 1e9, 1e30}) {
    TriangleSoup soup = seam_sphere(8, 6);
    for (Vec3f& p : soup.positions)
      p = {p.x * static_cast<float>(size), p.y * static_cast<float>(size), p.z * static_cast<float>(size)};
    std::vector<AssetLevel> levels(1);
    levels[0].mesh = mesh_of(soup);
    CAPTURE(size);
    AssetOptions options;
    options.compression = compression;
    const EncodedAsset encoding = encoded(levels, options);
    const auto read = decoded(encoding);
    CHECK(encoding.layout.notes.empty());
    CHECK(read[0].compression == compression);
    CHECK(read[0].mesh.face_count() == levels[0].mesh.face_count());
    CHECK(farthest_vertex(levels[0].mesh, read[0].mesh, 1e9 * size) <= 1.001 * encoding.layout.quantisation_error);
    CHECK(encoding.layout.quantisation_error < 1e-4 * 2 * size);
  }
}

TEST_CASE("draco keeps thin, long and small shapes from collapsing, and says what collapses where bits are given") {
  const auto stretched = [](TriangleSoup soup, double y, double z) {
    for (Vec3f& p : soup.positions) p = {p.x, p.y * static_cast<float>(y), p.z * static_cast<float>(z)};
    return soup;
  };
  const auto beside_small = [](double size) {
    TriangleSoup soup = icosphere(2, 0, 1);
    const TriangleSoup small = icosphere(1, 0, 1);
    const auto first = static_cast<Index>(soup.positions.size());
    for (const Vec3f& p : small.positions)
      soup.positions.push_back(
          {3 + p.x * static_cast<float>(size), p.y * static_cast<float>(size), p.z * static_cast<float>(size)});
    for (const Index i : small.indices) soup.indices.push_back(first + i);
    return soup;
  };
  for (const TriangleSoup& soup :
       {stretched(grid(5, 0, 1), 1e-5, 1), stretched(grid(5, 0, 1), 3e-7, 1), stretched(icosphere(2, 0, 1), 1e-5, 1e-5),
        stretched(cylinder(16, 40), 2e-5, 2e-5), beside_small(1e-4), beside_small(1e-5)}) {
    std::vector<AssetLevel> levels(1);
    levels[0].mesh = mesh_of(soup);
    const EncodedAsset encoding = encoded(levels, {});
    CHECK(encoding.layout.notes.empty());
    CHECK(encoding.layout.quantisation_error < 3e-5);
    CHECK(decoded(encoding)[0].mesh.face_count() == levels[0].mesh.face_count());
    AssetOptions coarse;
    coarse.position_bits = 10;
    const EncodedAsset collapsed = encoded(levels, coarse);
    REQUIRE(collapsed.layout.notes.size() == 1);
    CHECK_THAT(collapsed.layout.notes[0], contains("faces collapse on the grid"));
    CHECK(collapsed.layout.levels[0].face_count == levels[0].mesh.face_count());
    CHECK(decoded(collapsed)[0].mesh.face_count() < levels[0].mesh.face_count());
  }
}

TEST_CASE("compression moves no vertex farther than the options allow") {
  const Compression compression = GENERATE(Compression::Draco, Compression::Meshopt);
  std::vector<AssetLevel> levels(1);
  levels[0].mesh = mesh_of(seam_sphere(16, 12));
  for (const double most : {1e-2, 1e-5, 1e-7, 1e-9, 0.0}) {
    AssetOptions options;
    options.compression = compression;
    options.position_error = most;
    const EncodedAsset encoding = encoded(levels, options);
    CHECK(encoding.layout.quantisation_error <= most);
    CHECK(decoded(encoding)[0].compression == compression);
    CHECK(farthest_vertex(levels[0].mesh, decoded(encoding)[0].mesh) <= most);
  }
}

TEST_CASE("compression keeps whatever is data exactly, and texture coordinates by the texture's width") {
  const Compression compression = GENERATE(Compression::Draco, Compression::Meshopt);
  Random random(5);
  const Mesh bare = mesh_of(grid(9, 0.1, 1));
  const auto with_floats = [&](const std::string& name, std::uint8_t width, auto value) {
    std::vector<AssetLevel> levels(1);
    levels[0].mesh = bare;
    std::vector<float> values;
    for (std::size_t i = 0; i < width * bare.wedge_count(); ++i) values.push_back(static_cast<float>(value(i)));
    const auto bytes = std::as_bytes(std::span(values));
    levels[0].mesh.attributes = {{name, ComponentType::Float32, width, false, {bytes.begin(), bytes.end()}}};
    return levels;
  };
  AssetOptions options;
  options.compression = compression;
  options.position_error = 0;  // so that places tell which value is which
  const auto farthest_value = [&](const std::vector<AssetLevel>& levels) {
    const EncodedAsset encoding = encoded(levels, options);
    CHECK(encoding.layout.notes.empty());
    const Mesh mesh = decoded(encoding)[0].mesh;
    CHECK(mesh.face_count() == bare.face_count());
    const auto found = values_at_places(mesh), given = values_at_places(levels[0].mesh);
    REQUIRE(found.size() == given.size());
    double farthest = 0;
    for (const auto& [place, value] : given)
      for (std::size_t i = 0; i < value.size(); ++i)
        farthest = std::max(farthest, std::abs(double{value[i]} - double{found.at(place).at(i)}));
    return farthest;
  };
  const auto anything = [&](double scale) {
    return [&random, scale](std::size_t) { return scale * (random.unit() - 0.5); };
  };
  const auto whole = [&](double scale) {
    return [&random, scale](std::size_t) { return std::floor(scale * random.unit()); };
  };
  for (const double scale : {2.0, 1000.0, 70000.0, 8e6, 1.6e7, 1e9})
    CHECK(farthest_value(with_floats("_FEATURE_ID_0", 1, whole(scale))) == 0);
  CHECK(farthest_value(with_floats("_BATCHID", 1, [](std::size_t i) { return i == 7 ? -1.0 : 5e6 + double(i); })) == 0);
  CHECK(farthest_value(with_floats("_TEMPERATURE", 3, anything(40))) == 0);
  CHECK(farthest_value(
            with_floats("_SENTINEL", 1, [](std::size_t i) { return i % 5 == 0 ? -9999 : 0.1 * double(i); })) == 0);
  CHECK(farthest_value(with_floats("TEXCOORD_0", 2, [](std::size_t i) { return double(i % 65) / 64; })) == 0);
  for (const double range : {0.3, 1.0, 10.0, 1000.0, 1e5, 1e30})
    CHECK(farthest_value(with_floats("TEXCOORD_0", 2, [&](std::size_t i) { return i == 9 ? range : random.unit(); })) <=
          1.0 / 4095);
  CHECK(farthest_value(with_floats("COLOR_0", 3, [&](std::size_t i) { return i == 9 ? 200.0 : random.unit(); })) <=
        1.0 / 1023);
}

TEST_CASE("what draco cannot predict it encodes in another way") {
  // Texture coordinates are predicted from positions by products that so many bits are too many for.
  std::vector<AssetLevel> levels(1);
  levels[0].mesh = mesh_of(seam_sphere(12, 9));
  AssetOptions options;
  options.position_bits = options.texcoord_bits = 24;
  const EncodedAsset encoding = encoded(levels, options);
  CHECK(encoding.layout.notes.empty());
  CHECK(decoded(encoding)[0].compression == Compression::Draco);
  CHECK(decoded(encoding)[0].mesh.face_count() == levels[0].mesh.face_count());
  CHECK(farthest_vertex(levels[0].mesh, decoded(encoding)[0].mesh) < 1e-5);
}

TEST_CASE("however fine a grid is, draco takes no more memory than the mesh is worth") {
  std::vector<AssetLevel> levels(1);
  levels[0].mesh = mesh_of(seam_sphere(12, 9));
  const long before = peak_megabytes();
  for (const int bits : {24, 25, 27, 30})
    for (const int level : {7, 10}) {
      AssetOptions options;
      options.draco_compression_level = level;
      options.position_bits = options.normal_bits = options.texcoord_bits = bits;
      const EncodedAsset encoding = encoded(levels, options);
      INFO("bits " << bits << ", level " << level);
      CHECK(encoding.layout.notes.empty());
      const auto read = decoded(encoding);
      CHECK(read[0].compression == Compression::Draco);
      CHECK(read[0].mesh.face_count() == levels[0].mesh.face_count());
      CHECK(farthest_vertex(levels[0].mesh, read[0].mesh) < 1e-6);
    }
  AssetOptions options;
  options.position_grid = PositionGrid{{}, std::ldexp(1.0F, -28)};
  CHECK(farthest_vertex(levels[0].mesh, decoded(encoded(levels, options))[0].mesh) < 1e-6);
  if (!kReduced) CHECK(peak_megabytes() - before < 256);  // a sanitizer has its own limit on allocations
}

TEST_CASE("integer attributes pass compression exactly") {
  AssetOptions options;
  options.compression = GENERATE(Compression::Draco, Compression::Meshopt);
  std::vector<AssetLevel> levels(1);
  TriangleSoup soup = grid(4, 0.1, 1);
  Attribute color{"COLOR_0", ComponentType::UInt8, 4, true, {}};
  Attribute joints{"JOINTS_0", ComponentType::UInt16, 4, false, {}};
  for (std::size_t i = 0; i < soup.positions.size(); ++i) {
    for (int k = 0; k < 4; ++k) color.data.push_back(static_cast<std::byte>(i * 7 + static_cast<std::size_t>(k)));
    for (int k = 0; k < 8; ++k) joints.data.push_back(static_cast<std::byte>(k % 2 == 0 ? i : 1));
  }
  soup.attributes = {color, joints};
  levels[0].mesh = mesh_of(soup);
  TriangleSoup original = to_soup(levels[0].mesh), read = to_soup(decoded(encoded(levels, options)).at(0).mesh);
  const auto values = [](const TriangleSoup& s, std::size_t a) {
    std::multiset<std::vector<std::byte>> all;
    const std::size_t size = s.attributes.at(a).element_bytes();
    for (std::size_t i = 0; i < s.attributes[a].data.size(); i += size)
      all.insert({s.attributes[a].data.begin() + static_cast<std::ptrdiff_t>(i),
                  s.attributes[a].data.begin() + static_cast<std::ptrdiff_t>(i + size)});
    return all;
  };
  for (std::size_t a = 0; a < 2; ++a) CHECK(values(original, a) == values(read, a));
}

TEST_CASE("the binary chunk holds the coarsest level first, each in one piece, and the stream last") {
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    const EncodedAsset asset = encoded(sphere_levels(), options, 1000);
    const auto& levels = asset.layout.levels;
    REQUIRE(levels.size() == 3);
    CHECK(levels[2].byte_offset == 0);
    for (std::size_t i = 2; i-- > 0;) {
      const std::uint64_t end = levels[i + 1].byte_offset + levels[i + 1].byte_length;
      CHECK(levels[i].byte_offset >= end);
      CHECK(levels[i].byte_offset < end + 4);
    }
    CHECK(asset.layout.stream_bytes == 1000);
    CHECK(asset.glb.back() == std::byte{7});
    CHECK(asset.layout.total_bytes == asset.glb.size());
  }
}

TEST_CASE("the document follows MSFT_lod") {
  const std::string json = json_of(encoded(sphere_levels(), {}, 10));
  CHECK_THAT(json, contains(R"("MSFT_lod":{"ids":[2,3]})") && contains("MSFT_screencoverage") &&
                       contains(R"("extensionsRequired":["KHR_draco_mesh_compression"])") &&
                       contains(R"("generator":"lodestone 0.1.0")") &&
                       contains(R"("LODESTONE_removal_stream":{"bufferView")"));
  const auto read = decoded(encoded(sphere_levels(), {}));
  CHECK(read[0].screen_coverage > read[1].screen_coverage);
  CHECK(read[2].screen_coverage == 0);
}

TEST_CASE("readers without levels of detail see the finest level") {
  const ScratchDirectory scratch;
  const auto levels = sphere_levels();
  REQUIRE(write_file(scratch / "asset.glb", encoded(levels, {}).glb));
  const auto file = read_mesh(scratch / "asset.glb");
  REQUIRE(file);
  CHECK(file->mesh.face_count() == levels[0].mesh.face_count());
}

TEST_CASE("assets are the same bytes every time") {
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    CHECK(encoded(sphere_levels(), options, 5).glb == encoded(sphere_levels(), options, 5).glb);
  }
}

TEST_CASE("levels without faces have no mesh and are no error") {
  std::vector<AssetLevel> levels(2);
  levels[0].mesh = mesh_of(tetrahedron());
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    const auto read = decoded(encoded(levels, options, 3));
    REQUIRE(read.size() == 2);
    CHECK(read[0].mesh.face_count() == 4);
    CHECK(read[1].mesh.face_count() == 0);
    CHECK(decoded(encoded(std::span(levels).subspan(1), options))[0].mesh.face_count() == 0);
  }
}

TEST_CASE("an ordinary gltf is an asset of one level, without a stream") {
  const ScratchDirectory scratch;
  AssetOptions options;
  options.compression = Compression::None;
  const auto levels = sphere_levels();
  REQUIRE(write_file(scratch / "one.glb", encoded(std::span(levels).first(1), options).glb));
  const Asset asset = Asset::read(scratch / "one.glb").value();
  CHECK(asset.level_count() == 1);
  CHECK(asset.levels().value().size() == 1);
  CHECK(asset.streams().value().empty());
}

TEST_CASE("options out of range are named") {
  AssetOptions options;
  options.position_bits = 31;
  const auto asset = encode(sphere_levels(), options);
  REQUIRE_FALSE(asset);
  CHECK(asset.error().code == ErrorCode::InvalidArgument);
  CHECK_THAT(asset.error().message, contains("position_bits is 31"));
  const Scene scene = Scene::from_mesh({mesh_of(tetrahedron()), {}, {}, {}, {}}, "").value();
  CHECK_FALSE(encode_scene(scene, {}, {}));
  CHECK_FALSE(encode_scene(scene, std::vector<LeveledMesh>(1), {}));
}

TEST_CASE("every truncation of an asset is an error") {
  const auto levels = sphere_levels();
  const EncodedAsset asset = encoded(std::span(levels).subspan(2), {}, 3);
  for (std::size_t size = 0; size < asset.glb.size(); ++size)
    CHECK_FALSE(Asset::read_bytes(std::span(asset.glb).first(size)));
}

}  // namespace lodestone::test

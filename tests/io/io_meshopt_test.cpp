// Geometry packed by meshopt: what EXT_meshopt_compression wants of a file, and what comes out of it again. What holds
// for every compression is in io_asset_test and io_scene_test.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <string>

#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>

#include "support/data.h"
#include "support/gltf_file.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

constexpr const char* kExtension = "EXT_meshopt_compression";

AssetOptions packing() {
  AssetOptions options;
  options.compression = Compression::Meshopt;
  return options;
}

Scene scene_of(const TriangleSoup& soup) { return Scene::from_mesh({mesh_of(soup), {}, {}, {}, {}}, "shape").value(); }

LeveledMesh levels_of(const Scene& scene, std::size_t count) {
  LeveledMesh mesh;
  mesh.levels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Mesh& level = mesh.levels[i].mesh = scene.meshes()[0].mesh;
    level.corner_wedge.resize(level.face_count() / (i + 1) * 3);
    level.face_material.resize(std::min(level.face_material.size(), level.face_count()));
  }
  return mesh;
}

EncodedAsset packed(const Scene& scene, const AssetOptions& options = packing(), std::size_t level_count = 3) {
  const LeveledMesh mesh = levels_of(scene, level_count);
  auto asset = encode_scene(scene, std::span(&mesh, 1), options);
  INFO((asset ? std::string() : asset.error().message));
  REQUIRE(asset);
  return std::move(*asset);
}

Mesh finest(const EncodedAsset& asset) {
  return Asset::read_bytes(asset.glb).value().scene().value().meshes().at(0).mesh;
}

const Attribute& attribute_named(const Mesh& mesh, const std::string& name) {
  for (const Attribute& a : mesh.attributes)
    if (a.name == name) return a;
  FAIL("no " << name);
  throw 0;
}

/// A hilly grid with directions at its points, and its points numbered.
TriangleSoup with_directions(const std::string& name, std::uint8_t width, Random& random) {
  TriangleSoup soup = grid(9, 0.1, 1);
  std::vector<float> values, numbers;
  for (std::size_t i = 0; i < soup.positions.size(); ++i) {
    const Vec3 direction = normalized(Vec3{random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5});
    for (const double x : {direction.x, direction.y, direction.z}) values.push_back(static_cast<float>(x));
    if (width == 4) values.push_back(i % 2 == 0 ? 1.0F : -1.0F);
    numbers.push_back(static_cast<float>(i));
  }
  const auto add = [&](const std::string& attribute, std::uint8_t components, std::span<const float> floats) {
    const auto bytes = std::as_bytes(floats);
    soup.attributes.push_back({attribute, ComponentType::Float32, components, false, {bytes.begin(), bytes.end()}});
  };
  add(name, width, values);
  add("_NUMBER", 1, numbers);
  return soup;
}

}  // namespace

TEST_CASE("packed files are laid out as the extension says") {
  Random random(3);
  for (const TriangleSoup& soup :
       {icosphere(2, 0, 1), seam_sphere(8, 6), two_material_grid(4), skinned_cylinder(8, 6), morph_grid(8),
        with_directions("NORMAL", 3, random), with_directions("TANGENT", 4, random)}) {
    const GltfFile file = GltfFile::from_glb(packed(scene_of(soup)).glb);
    const GltfJson& json = file.json;
    const std::set<std::string> required(json["extensionsRequired"].begin(), json["extensionsRequired"].end());
    CHECK(required.contains(kExtension));
    REQUIRE(json["buffers"].size() == 2);
    CHECK(json["buffers"][1]["extensions"][kExtension]["fallback"] == true);
    CHECK_FALSE(json["buffers"][1].contains("uri"));
    std::size_t end = 0;  // of what views unpack to
    bool has_integers = false;
    for (const GltfJson& view : json["bufferViews"]) {
      REQUIRE(view["extensions"].contains(kExtension));
      const GltfJson& extension = view["extensions"][kExtension];
      CHECK(view["buffer"] == 1);
      CHECK(view["byteOffset"].get<std::size_t>() >= end);
      CHECK(view["byteOffset"].get<std::size_t>() % 4 == 0);
      end = view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>();
      CHECK(extension["buffer"] == 0);
      CHECK(extension["count"].get<std::size_t>() * extension["byteStride"].get<std::size_t>() == view["byteLength"]);
      const bool is_triangles = extension["mode"] == "TRIANGLES";
      CHECK(view.contains("byteStride") != is_triangles);
      // The versions that the extension allows.
      const auto first = file.buffers[0].at(extension["byteOffset"].get<std::size_t>());
      CHECK(first == (is_triangles ? std::byte{0xe1} : std::byte{0xa0}));
      has_integers |= extension.value("filter", "") == "OCTAHEDRAL";
    }
    CHECK(end <= json["buffers"][1]["byteLength"].get<std::size_t>());
    CHECK(required.contains("KHR_mesh_quantization") == has_integers);
  }
}

TEST_CASE("positions lie on a grid of a power of two, the same in every level, and exactly on it") {
  for (const int bits : {6, 12, 18}) {
    AssetOptions options = packing();
    options.position_bits = bits;
    TriangleSoup soup = icosphere(2, 0, 1);
    for (Vec3f& p : soup.positions) p = {p.x * 0.3F + 5, p.y * 0.3F - 7, p.z * 0.3F};
    const EncodedAsset asset = packed(scene_of(soup), options);
    const double step = std::exp2(std::floor(std::log2(0.6 / (std::exp2(bits) - 1))));
    const std::vector<Asset::Level> levels = Asset::read_bytes(asset.glb).value().levels().value();
    for (const Asset::Level& level : levels)
      for (const Vec3f& p : level.mesh.positions)
        for (const float x : {p.x, p.y, p.z}) CHECK(std::remainder(static_cast<double>(x), step) == 0);
    CHECK(asset.layout.quantisation_error == test::Approx(std::sqrt(3.0) / 2 * step));
  }
}

TEST_CASE("directions keep theirs as far as their bits go, and what marks their side") {
  Random random(11);
  for (const int bits : {6, 8, 10, 16})
    for (const bool tangents : {false, true}) {
      const std::string name = tangents ? "TANGENT" : "NORMAL";
      const std::uint8_t width = tangents ? 4 : 3;
      const Mesh given = mesh_of(with_directions(name, width, random));
      AssetOptions options = packing();
      options.normal_bits = options.generic_bits = bits;
      const Mesh read = finest(packed(scene_of(to_soup(given)), options));
      const Attribute& stored = attribute_named(read, name);
      CHECK(stored.type == (bits > 8 ? ComponentType::Int16 : ComponentType::Int8));
      CHECK(stored.normalized);
      const std::vector<float> before = attribute_values(attribute_named(given, name)),
                               after = attribute_values(stored);
      const std::vector<float> old_numbers = attribute_values(attribute_named(given, "_NUMBER"));
      const std::vector<float> numbers = attribute_values(attribute_named(read, "_NUMBER"));
      std::map<float, std::size_t> wedge;
      for (std::size_t i = 0; i < old_numbers.size(); ++i) wedge[old_numbers[i]] = i;
      REQUIRE(numbers.size() == old_numbers.size());
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const float *a = before.data() + wedge.at(numbers[i]) * width, *b = after.data() + i * width;
        const double angle = angle_between(Vec3{a[0], a[1], a[2]}, Vec3{b[0], b[1], b[2]});
        CHECK(angle <= 3.0 / (std::exp2(bits - 1) - 1) + 1e-4);
        if (tangents) CHECK(a[3] == b[3]);
      }
    }
}

TEST_CASE("skin weights still sum to 1, joints are the same") {
  Random random(7);
  TriangleSoup soup = skinned_cylinder(12, 9);
  Attribute* weights = nullptr;
  for (Attribute& a : soup.attributes)
    if (a.name == "WEIGHTS_0") weights = &a;
  REQUIRE(weights != nullptr);
  REQUIRE(weights->type == ComponentType::Float32);
  std::vector<float> values;
  for (std::size_t i = 0; i < soup.positions.size(); ++i) {
    const double parts[] = {random.unit(), random.unit(), random.unit(), random.unit()};
    const double sum = std::accumulate(std::begin(parts), std::end(parts), 0.0);
    for (const double part : parts) values.push_back(static_cast<float>(part / sum));
  }
  std::memcpy(weights->data.data(), values.data(), weights->data.size());
  const Mesh read = finest(packed(scene_of(soup)));
  const std::vector<float> after = attribute_values(attribute_named(read, "WEIGHTS_0"));
  for (std::size_t i = 0; i < after.size(); i += 4) {
    CHECK(after[i] + after[i + 1] + after[i + 2] + after[i + 3] == 1);
    for (std::size_t k = 0; k < 4; ++k) CHECK(std::remainder(after[i + k], 1.0F / 4096) == 0);
  }
}

TEST_CASE("what only has the name of weights or directions is data") {
  Random random(13);
  TriangleSoup soup = skinned_cylinder(12, 9);
  const std::size_t count = soup.positions.size();
  const auto add = [&](const std::string& name, std::uint8_t width) {
    std::vector<float> values;
    for (std::size_t i = 0; i < width * count; ++i) values.push_back(static_cast<float>(3 * random.unit()));
    const auto bytes = std::as_bytes(std::span(values));
    soup.attributes.push_back({name, ComponentType::Float32, width, false, {bytes.begin(), bytes.end()}});
  };
  add("WEIGHTS_1", 2);
  add("NORMAL", 2);
  add("TANGENT", 3);
  const Mesh read = finest(packed(scene_of(soup)));
  for (const char* name : {"_NORMAL", "_TANGENT"}) {
    const Attribute& a = attribute_named(read, name);
    CHECK(a.type == ComponentType::Float32);
    const std::vector<float> values = attribute_values(a);
    CHECK(*std::max_element(values.begin(), values.end()) > 2);
  }
  CHECK(attribute_named(read, "_WEIGHTS_1").component_count == 2);
}

TEST_CASE("levels with floats fit a file whose directions were packed") {
  Random random(5);
  const Scene scene = scene_of(with_directions("NORMAL", 3, random));
  const EncodedAsset first = packed(scene);
  const Scene again = Asset::read_bytes(first.glb).value().scene().value();
  // As they come out of a stream, which keeps what the file was made of.
  const LeveledMesh floats = levels_of(scene, 2);
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    const auto asset = encode_scene(again, std::span(&floats, 1), options);
    REQUIRE(asset);
    const Mesh read = finest(*asset);
    CHECK(attribute_named(read, "NORMAL").type == ComponentType::Int16);
    CHECK(read.face_count() == scene.meshes()[0].mesh.face_count());
  }
}

TEST_CASE("packing what is packed already changes nothing") {
  Random random(9);
  for (const TriangleSoup& soup : {seam_sphere(8, 6), skinned_cylinder(8, 6), with_directions("NORMAL", 3, random)}) {
    AssetOptions options = packing();
    options.position_grid = PositionGrid{{}, 1e-3F};
    const EncodedAsset once = packed(scene_of(soup), options, 1);
    const Scene read = Asset::read_bytes(once.glb).value().scene().value();
    const EncodedAsset twice = packed(read, options, 1);
    CHECK(triangle_set(finest(once)) == triangle_set(finest(twice)));
  }
}

TEST_CASE("the models' files are a fraction of the plain ones") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  for (const char* name : {"gltf/FlightHelmet/FlightHelmet.gltf", "skin-morph/MorphStressTest.gltf"}) {
    const Scene scene = Scene::read(*models_directory() / name).value();
    std::vector<LeveledMesh> meshes;
    for (const SceneMesh& mesh : scene.meshes()) meshes.emplace_back().levels.push_back({mesh.mesh, {}, 0, "whole"});
    std::map<Compression, double> bytes;
    for (const Compression compression : {Compression::None, Compression::Meshopt}) {
      AssetOptions options;
      options.compression = compression;
      const EncodedAsset asset = encode_scene(scene, meshes, options).value();
      bytes[compression] = static_cast<double>(asset.layout.levels[0].geometry_bytes);
    }
    CHECK(bytes[Compression::Meshopt] < 0.4 * bytes[Compression::None]);
  }
}

}  // namespace lodestone::test

// What becomes of a mesh that Draco refuses. No mesh is known that it refuses in every way, so that its encoder is made
// to (the linker's --wrap, see CMakeLists.txt).

#include <draco/compression/expert_encode.h>

#include <algorithm>
#include <atomic>
#include <string>

#include <lodestone/core/parallel.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>

#include "support/gltf_shapes.h"
#include "support/mesh_properties.h"

namespace {

std::atomic<int> refusals_left = 0;

}  // namespace

// The names that the linker gives the two: Draco's own function, and what stands in its place.
draco::Status encode_really(draco::ExpertEncoder* encoder, draco::EncoderBuffer* buffer) __asm__(
    "__real__ZN5draco13ExpertEncoder14EncodeToBufferEPNS_13EncoderBufferE");
draco::Status encode_or_refuse(draco::ExpertEncoder* encoder, draco::EncoderBuffer* buffer) __asm__(
    "__wrap__ZN5draco13ExpertEncoder14EncodeToBufferEPNS_13EncoderBufferE");

draco::Status encode_or_refuse(draco::ExpertEncoder* encoder, draco::EncoderBuffer* buffer) {
  if (refusals_left-- > 0) return draco::Status(draco::Status::DRACO_ERROR, "not today");
  return encode_really(encoder, buffer);
}

namespace lodestone::test {
namespace {

constexpr int kAlways = 1'000'000;
constexpr int kWays = 3;  // in which a mesh without morph targets is tried

/// A sphere of two materials, in two levels; with all that clients see of them when it has been encoded.
struct Trial {
  Scene scene;
  LeveledMesh mesh;
  std::vector<AssetLevel> seen;

  explicit Trial(Scene from) : scene(std::move(from)) {
    for (int level = 0; level < 2; ++level) mesh.levels.push_back({scene.meshes()[0].mesh, {}, 0, "faces"});
    Mesh& coarse = mesh.levels[1].mesh;
    coarse.corner_wedge.resize(coarse.face_count() / 4 * 3);
    coarse.face_material.resize(std::min(coarse.face_material.size(), coarse.face_count()));
  }

  EncodedAsset encode(int refusals) {
    refusals_left = refusals;
    AssetOptions options;
    options.keep_decoded = true;
    Result<EncodedGeometry> geometry = fail(ErrorCode::Malformed, "not made");
    // One after the other: the refusals are the first primitive's.
    with_threads(1, [&] { geometry = encode_geometry(scene, std::span(&mesh, 1), options); });
    refusals_left = 0;
    REQUIRE(geometry);
    seen = geometry->levels()[0];
    auto asset = write_asset(std::move(*geometry));
    REQUIRE(asset);
    return std::move(*asset);
  }
};

Scene two_materials() { return Scene::from_mesh({mesh_of(two_material_sphere(2)), {}, {}, {}, {}}, "sphere").value(); }

/// A sphere with a morph target that grows it.
Scene morphed() {
  GltfMaker maker;
  const TriangleSoup sphere = icosphere(2, 0, 1);
  add_node(maker, "sphere", add_mesh(maker, "sphere", sphere));
  std::vector<float> moved;
  for (const Vec3f& p : sphere.positions) moved.insert(moved.end(), {p.x, p.y, p.z});
  maker.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", maker.add_floats(moved, "VEC3", 3)}}};
  return Scene::read_bytes(maker.glb(), "glb").value();
}

std::size_t compressed_count(const GltfFile& file) {
  std::size_t count = 0;
  for (const GltfJson& mesh : file.json["meshes"])
    for (const GltfJson& primitive : mesh["primitives"])
      count += primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression");
  return count;
}

}  // namespace

TEST_CASE("what Draco refuses in every way is stored plainly, bit for bit, and that is said") {
  for (const bool with_targets : {false, true}) {
    Trial trial(with_targets ? morphed() : two_materials());
    const EncodedAsset encoded = trial.encode(kAlways);
    const GltfFile file = GltfFile::from_glb(encoded.glb);
    CHECK(compressed_count(file) == 0);
    CHECK_FALSE(file.json.contains("extensionsRequired"));
    const std::vector<std::string>& notes = encoded.layout.notes;
    REQUIRE(notes.size() == (with_targets ? 1 : 2));
    CHECK(notes[0] == "mesh 0 primitive 0 is stored without Draco: Draco: not today");
    for (std::size_t level = 0; level < 2; ++level) {
      const Mesh& mesh = trial.mesh.levels[level].mesh;
      CHECK(encoded.layout.levels[level].face_count == mesh.face_count());
      CHECK(triangle_set(trial.seen[level].mesh) == triangle_set(mesh));
    }
    const Scene read = Asset::read_bytes(encoded.glb).value().scene().value();
    CHECK(triangle_set(read.meshes()[0].mesh) == triangle_set(trial.mesh.levels[0].mesh));
  }
}

TEST_CASE("what Draco refuses in one way it encodes in another, without a word") {
  for (int refusals = 1; refusals < kWays; ++refusals) {
    Trial trial(two_materials());
    const EncodedAsset encoded = trial.encode(refusals);
    CHECK(encoded.layout.notes.empty());
    CHECK(compressed_count(GltfFile::from_glb(encoded.glb)) == 4);
  }
}

TEST_CASE("what Draco refuses of one primitive does not keep the others from it") {
  Trial trial(two_materials());
  const EncodedAsset encoded = trial.encode(kWays);
  CHECK(encoded.layout.notes.size() == 1);
  CHECK(compressed_count(GltfFile::from_glb(encoded.glb)) == 3);
  const std::vector<Asset::Level> levels = Asset::read_bytes(encoded.glb).value().levels().value();
  for (std::size_t level = 0; level < 2; ++level)
    CHECK(levels[level].mesh.face_count() == trial.mesh.levels[level].mesh.face_count());
}

}  // namespace lodestone::test

#include <lodestone/io/tinygltf_model.h>

#include <algorithm>
#include <sstream>

#include <lodestone/pipeline/build_asset.h>

#include "support/data.h"
#include "support/gltf_shapes.h"
#include "support/tinygltf.h"

namespace lodestone::test {
namespace {

AssetOptions plain() {
  AssetOptions options;
  options.compression = Compression::None;
  return options;
}

/// The scene as it is, in one level.
EncodedAsset whole(const Scene& scene, const AssetOptions& options) {
  std::vector<LeveledMesh> levels(scene.meshes().size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].levels.resize(1);
    levels[i].levels[0].mesh = scene.meshes()[i].mesh;
  }
  return encode_scene_level(scene, levels, 0, options).value();
}

tinygltf::Model model_of(const EncodedAsset& asset) {
  auto model = model_from_asset(asset);
  INFO((model ? "" : model.error().message));
  REQUIRE(model);
  return std::move(*model);
}

Scene scene_of(const tinygltf::Model& model) {
  auto scene = scene_from_model(model);
  INFO((scene ? "" : scene.error().message));
  REQUIRE(scene);
  return std::move(*scene);
}

void check_same(const Scene& a, const Scene& b) {
  REQUIRE(a.meshes().size() == b.meshes().size());
  for (std::size_t i = 0; i < a.meshes().size(); ++i) {
    const SceneMesh &from = a.meshes()[i], &to = b.meshes()[i];
    INFO("mesh " << i << " '" << from.name << "'");
    CHECK(to.name == from.name);
    CHECK(to.materials == from.materials);
    CHECK(to.nodes == from.nodes);
    CHECK(to.instance_count == from.instance_count);
    CHECK(to.scale == from.scale);
    CHECK(to.skinned == from.skinned);
    CHECK(to.target_reach == from.target_reach);
    CHECK((triangle_set(to.mesh) == triangle_set(from.mesh)));
  }
}

/// One triangle, shown by one node.
tinygltf::Model triangle_model() {
  const Mesh mesh = mesh_of(single_triangle());
  return model_of(whole(Scene::from_mesh({mesh, {}, {}, {}, {}}, "triangle").value(), plain()));
}

Error error_of(const tinygltf::Model& model) {
  const auto scene = scene_from_model(model);
  REQUIRE_FALSE(scene);
  return scene.error();
}

tinygltf::Value nested(int depth) {
  tinygltf::Value value(1);
  for (int i = 0; i < depth; ++i) value = tinygltf::Value(tinygltf::Value::Array{std::move(value)});
  return value;
}

/// The bytes of a PNG that is none, but begins as one.
std::vector<std::byte> png_bytes() {
  std::vector<std::byte> bytes;
  for (const int b : {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0, 1, 2, 3, 250}) bytes.push_back(std::byte(b));
  return bytes;
}

/// A textured square; its image is in the file.
Scene textured_scene() {
  MeshFile file{mesh_of(seam_cube(2)), {}, {}, {}, {}};
  file.mesh.face_material.assign(file.mesh.face_count(), 1);
  Material material;
  material.name = "painted";
  material.base_color_texture = Texture{0, {2, 1}, {0, 0.5F}, true};
  file.materials.push_back(material);
  file.images.push_back({"paint.png", "image/png", png_bytes()});
  return Scene::from_mesh(std::move(file), "box").value();
}

}  // namespace

TEST_CASE("a scene comes back from a model as it went, over families of shapes") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    MeshFile file;
    file.mesh = mesh_of(shape.soup);
    const Scene scene =
        Scene::read_bytes(whole(Scene::from_mesh(file, shape.name).value(), plain()).glb, "glb").value();
    check_same(scene, scene_of(model_of(whole(scene, plain()))));
  }
}

TEST_CASE("a scene comes back from a model as it went: real files") {
  std::vector<std::filesystem::path> files = {demo_model()};
  for (const char* name : {"gltf/ShapeCollection.glb", "gltf/chr_knight.glb", "gltf/MultiUVTest/MultiUVTest.gltf",
                           "skin-morph/AnimatedMorphCube/AnimatedMorphCube.gltf", "skin-morph/RobotExpressive.glb"})
    if (const auto path = model(name)) files.push_back(*path);
  for (const std::filesystem::path& path : files) {
    INFO(path.string());
    const Scene scene = Scene::read(path).value();
    const tinygltf::Model model = model_of(whole(scene, plain()));
    check_same(scene, scene_of(model));
    AssetOptions separate = plain();
    separate.gltf_name = "scene";
    CHECK(model_of(whole(scene, separate)).meshes == model.meshes);
  }
}

TEST_CASE("images keep their bytes both ways, in a .glb and beside a .gltf") {
  const Scene scene = textured_scene();
  for (const char* name : {"", "box"}) {
    AssetOptions options = plain();
    options.gltf_name = name;
    tinygltf::Model model = model_of(whole(scene, options));
    REQUIRE(model.images.size() == 1);
    CHECK(model.images[0].as_is);
    CHECK(std::ranges::equal(std::as_bytes(std::span(model.images[0].image)), png_bytes()));
    const GltfFile back = GltfFile::from_glb(whole(scene_of(model), plain()).glb);
    CHECK(back.image_bytes(0) == png_bytes());
    CHECK(back.json["images"][0]["mimeType"] == "image/png");

    // As a program has it that made the image itself.
    model.images[0].bufferView = -1;
    model.images[0].uri.clear();
    const GltfFile made = GltfFile::from_glb(whole(scene_of(model), plain()).glb);
    CHECK(made.image_bytes(0) == png_bytes());
    CHECK_FALSE(made.json["images"][0].contains("uri"));
  }
}

TEST_CASE("an image of pixels is refused, one that is known by name stays outside") {
  tinygltf::Model model = model_of(whole(textured_scene(), plain()));
  model.images[0].bufferView = -1;
  model.images[0].as_is = false;
  CHECK(error_of(model).code == ErrorCode::Unsupported);
  CHECK_THAT(error_of(model).message, contains("image 0"));
  model.images[0].uri = "paint.png";
  const Scene scene = scene_of(model);
  REQUIRE(scene.notes().size() == 1);
  CHECK_THAT(scene.notes()[0], contains("'paint.png'"));
}

TEST_CASE("a built asset as a model has its levels and its streams") {
  const Scene scene = Scene::from_mesh({mesh_of(icosphere(3, 0.02, 7)), {}, {}, {}, {}}, "ball").value();
  BuildOptions options;
  options.storage = plain();
  const auto built = build_asset(scene, options);
  REQUIRE(built);
  const tinygltf::Model model = model_of(built->files[0]);
  const auto lod = std::find_if(model.nodes.begin(), model.nodes.end(),
                                [](const tinygltf::Node& node) { return node.extensions.contains("MSFT_lod"); });
  REQUIRE(lod != model.nodes.end());
  CHECK(lod->extensions.at("MSFT_lod").Get("ids").ArrayLen() + 1 == built->levels.size());

  std::ostringstream written;
  tinygltf::TinyGLTF writer;
  REQUIRE(writer.WriteGltfSceneToStream(&model, written, false, true));
  const std::string bytes = written.str();
  const auto read = [](std::span<const std::byte> glb, std::size_t level) {
    return Asset::read_bytes(glb).value().scene(level).value();
  };
  for (std::size_t level = 0; level < built->levels.size(); ++level)
    check_same(read(built->files[0].glb, level), read(std::as_bytes(std::span(bytes)), level));
  CHECK(read(built->files[0].glb, 0).meshes()[0].stream == read(std::as_bytes(std::span(bytes)), 0).meshes()[0].stream);
  CHECK_THAT(error_of(model).message, contains("already has levels"));
}

TEST_CASE("a model that says what is not so is refused as a file is") {
  const tinygltf::Model good = triangle_model();
  REQUIRE(scene_from_model(good));
  struct Breakage {
    const char* message;
    void (*apply)(tinygltf::Model&);
  };
  const Breakage breakages[] = {
      {"mesh 7 does not exist", [](tinygltf::Model& m) { m.nodes[0].mesh = 7; }},
      {"accessor 33 does not exist", [](tinygltf::Model& m) { m.meshes[0].primitives[0].indices = 33; }},
      {"buffer view 5 does not exist", [](tinygltf::Model& m) { m.accessors[0].bufferView = 5; }},
      {"exceeds buffer view", [](tinygltf::Model& m) { m.accessors[0].count = 1000; }},
      {"exceed buffer 0", [](tinygltf::Model& m) { m.bufferViews[0].byteLength = 100000; }},
      {"componentType is -1", [](tinygltf::Model& m) { m.accessors[0].componentType = -1; }},
      {"is 200: there are 3 vertices",
       [](tinygltf::Model& m) {
         m.buffers[0].data.back() = 200;
         m.buffers[0].data[m.bufferViews[1].byteOffset] = 200;
       }},
      {"version", [](tinygltf::Model& m) { m.asset.version = "3.0"; }},
      {"not supported", [](tinygltf::Model& m) { m.extensionsRequired = {"X_unheard_of"}; }},
      {"UTF-8", [](tinygltf::Model& m) { m.nodes[0].name = "\xff"; }},
      {"nest deeper", [](tinygltf::Model& m) { m.extras = nested(300); }},
      {"nest deeper", [](tinygltf::Model& m) { m.nodes[0].extensions["X_x"] = nested(3000); }},
      {"EXT_meshopt_compression",
       [](tinygltf::Model& m) { m.bufferViews[0].extensions["EXT_meshopt_compression"] = nested(1); }},
  };
  for (const Breakage& breakage : breakages) {
    tinygltf::Model model = good;
    breakage.apply(model);
    INFO(breakage.message);
    CHECK_THAT(error_of(model).message, contains(breakage.message));
  }
}

TEST_CASE("whatever part of a model nests too deep is found") {
  using Model = tinygltf::Model;
  using Deep = tinygltf::Value& (*)(Model&);
  const Deep places[] = {[](Model & m) -> auto& {return m.extensions["X"];
}
, [](Model& m) -> auto& { return m.asset.extras; }
, [](Model& m) -> auto& { return m.accessors.emplace_back().extras; }
, [](Model& m) -> auto& { return m.animations.emplace_back().samplers.emplace_back().extensions["X"]; }
, [](Model& m) -> auto& { return m.animations.emplace_back().channels.emplace_back().target_extensions["X"]; }
, [](Model& m) -> auto& { return m.buffers.emplace_back().extras; }
, [](Model& m) -> auto& { return m.bufferViews.emplace_back().extras; }
, [](Model& m) -> auto& { return m.cameras.emplace_back().perspective.extras; }
, [](Model& m) -> auto& { return m.cameras.emplace_back().orthographic.extensions["X"]; }
, [](Model& m) -> auto& {
  m.images.emplace_back().uri = "paint.png";
  return m.images[0].extras;
}
, [](Model& m) -> auto& { return m.lights.emplace_back().spot.extras; }
, [](Model& m) -> auto& { return m.materials.emplace_back().extensions["X"]; }
, [](Model& m) -> auto& { return m.materials.emplace_back().pbrMetallicRoughness.baseColorTexture.extras; }
, [](Model& m) -> auto& { return m.materials.emplace_back().emissiveTexture.extensions["X"]; }
, [](Model& m) -> auto& { return m.meshes.emplace_back().primitives.emplace_back().extras; }
, [](Model& m) -> auto& { return m.nodes.emplace_back().extras; }
, [](Model& m) -> auto& { return m.samplers.emplace_back().extras; }
, [](Model& m) -> auto& { return m.scenes.emplace_back().extras; }
, [](Model& m) -> auto& { return m.skins.emplace_back().extensions["X"]; }
, [](Model& m) -> auto& { return m.textures.emplace_back().extras; }
,
};  // namespace lodestone::test
for (std::size_t i = 0; i < std::size(places); ++i) {
  CAPTURE(i);
  Model model;
  places[i](model) = tinygltf::Value(tinygltf::Value::Object{{"deep", nested(300)}});
  CHECK_THAT(error_of(model).message, contains("model: extras or extensions nest deeper"));
}
}

TEST_CASE("objects without members stay objects") {
  tinygltf::Model model = triangle_model();
  model.nodes.emplace_back();
  model.textures.emplace_back();
  model.animations.emplace_back();
  model.nodes[0].extras = tinygltf::Value(tinygltf::Value::Object{{"said", tinygltf::Value(std::string("\"null\" \\"))},
                                                                  {"list", tinygltf::Value(tinygltf::Value::Array{})}});
  const GltfFile back = GltfFile::from_glb(whole(scene_of(model), plain()).glb);
  CHECK(back.json["nodes"][1] == GltfJson::object());
  CHECK(back.json["textures"][0] == GltfJson::object());
  CHECK_FALSE(back.json.contains("animations"));
  CHECK(back.json["nodes"][0]["extras"]["said"] == "\"null\" \\");
}

TEST_CASE("an empty model is an empty scene") { CHECK(scene_of(tinygltf::Model()).meshes().empty()); }

TEST_CASE("an asset that tinygltf does not load is refused with a reason") {
  const Scene scene = textured_scene();
  const auto message = [](const EncodedAsset& asset) {
    const auto model = model_from_asset(asset);
    REQUIRE_FALSE(model);
    return model.error().message;
  };
  CHECK_THAT(message(whole(scene, {})), contains("Draco"));
  CHECK_THAT(message({}), contains("json"));

  EncodedAsset cut = whole(scene, plain());
  cut.glb.resize(cut.glb.size() - 100);
  CHECK_FALSE(message(cut).empty());

  AssetOptions separate = plain();
  separate.gltf_name = "box";
  EncodedAsset alone = whole(scene, separate);
  alone.beside.clear();
  CHECK_THAT(message(alone), contains("'box.bin'"));

  // Where tinygltf alone would read beyond the buffer.
  GltfMaker outside;
  outside.add_floats({1, 2, 3}, "SCALAR", 1);
  outside.add("bufferViews", {{"buffer", 0}, {"byteOffset", 4000000000u}, {"byteLength", 1000000}});
  outside.add("images", {{"bufferView", 1}, {"mimeType", "image/png"}});
  CHECK_THAT(message({outside.glb(), {}, {}}), contains("buffer view 1"));
}

}  // namespace lodestone::test

#include <lodestone/io/scene.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/deviation.h>

#include "support/data.h"
#include "support/gltf_file.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

/// Levels without a simplifier: the mesh, again the mesh if wanted, and the first half of its faces.
LeveledMesh halved(const SceneMesh& mesh, std::size_t level_count = 2) {
  LeveledMesh leveled;
  for (std::size_t i = 0; i < level_count; ++i) leveled.levels.push_back({mesh.mesh, {}, 0, "faces"});
  Mesh& coarse = leveled.levels.back().mesh;
  if (level_count == 1) return leveled;
  coarse.corner_wedge.resize(std::max<std::size_t>(coarse.face_count() / 2, 1) * 3);
  coarse.face_material.resize(std::min(coarse.face_material.size(), coarse.face_count()));
  leveled.levels.back().deviation.forward.maximum = 0.01;
  return leveled;
}

std::vector<LeveledMesh> halved(const Scene& scene, std::size_t level_count = 2) {
  std::vector<LeveledMesh> meshes;
  for (const SceneMesh& mesh : scene.meshes()) meshes.push_back(halved(mesh, level_count));
  return meshes;
}

AssetOptions plain() {
  AssetOptions options;
  options.compression = Compression::None;
  return options;
}

template <class T>
T checked(Result<T> result) {
  INFO((result ? std::string() : result.error().message));
  REQUIRE(result);
  return std::move(*result);
}

Scene read(GltfMaker& maker) { return checked(Scene::read_bytes(maker.glb(), "glb")); }

GltfFile encoded(const Scene& scene, const AssetOptions& options, std::size_t level_count = 2) {
  return GltfFile::from_glb(checked(encode_scene(scene, halved(scene, level_count), options)).glb);
}

std::string error_of(GltfMaker& maker) {
  const auto scene = Scene::read_bytes(maker.glb(), "glb");
  REQUIRE_FALSE(scene);
  return scene.error().message;
}

/// A flat strip of quads along x from `begin` on, as triangles.
std::vector<float> strip_positions(int begin, int quads) {
  std::vector<float> values;
  for (int i = 0; i <= quads; ++i)
    for (const int y : {0, 1}) values.insert(values.end(), {static_cast<float>(begin + i), static_cast<float>(y), 0});
  return values;
}
std::vector<std::uint16_t> strip_indices(int quads) {
  std::vector<std::uint16_t> indices;
  for (int i = 0; i < 2 * quads; i += 2)
    for (const int k : {0, 2, 1, 1, 2, 3}) indices.push_back(static_cast<std::uint16_t>(i + k));
  return indices;
}

/// Adds a primitive of such a strip.
GltfJson strip_primitive(GltfMaker& maker, int begin, int quads) {
  const std::size_t positions = maker.add_floats(strip_positions(begin, quads), "VEC3", 3);
  const std::size_t indices = maker.add_accessor(strip_indices(quads), 5123, "SCALAR", 1);
  return {{"attributes", {{"POSITION", positions}}}, {"indices", indices}};
}

/// One node that shows one mesh of strips with `quads` each, one after the other along x.
GltfMaker strips(int primitive_count, int quads) {
  GltfMaker maker;
  maker.json["scene"] = 0;
  maker.add("scenes", {{"nodes", {0}}});
  maker.add("nodes", {{"name", "node"}, {"mesh", 0}});
  GltfJson primitives = GltfJson::array();
  for (int i = 0; i < primitive_count; ++i) primitives.push_back(strip_primitive(maker, i * quads, quads));
  maker.add("meshes", {{"name", "strips"}, {"primitives", primitives}});
  return maker;
}

std::size_t faces_of_primitive(const GltfFile& file, const GltfJson& primitive) {
  return file.json["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>() / 3;
}

const GltfJson* lod_node(const GltfFile& file, const std::string& name) {
  for (const GltfJson& node : file.json["nodes"])
    if (node.value("name", "") == name) return &node;
  return nullptr;
}

// What a file keeps, compared with the file it was made from.

/// Members may come back in another order.
nlohmann::json unordered(const GltfJson& json) { return nlohmann::json::parse(json.dump()); }

void check_equal(const GltfJson& in, const GltfJson& out, const char* member) {
  INFO("member " << member);
  CHECK(in.contains(member) == out.contains(member));
  if (in.contains(member) && out.contains(member)) CHECK(unordered(in[member]) == unordered(out[member]));
}

std::set<std::size_t> moved_nodes(const GltfFile& in, const GltfFile& out) {
  std::set<std::size_t> moved;
  for (std::size_t i = 0; i < in.json["nodes"].size(); ++i)
    if (in.json["nodes"][i].contains("mesh") && !out.json["nodes"][i].contains("mesh")) moved.insert(i);
  return moved;
}

/// Takes out of a node what makes it the finest level where it stands.
void take_out_lod(GltfJson& node) {
  node["extensions"].erase("MSFT_lod");
  for (const char* member : {"lodestone", "MSFT_screencoverage"}) node["extras"].erase(member);
  for (const char* member : {"extensions", "extras"})
    if (node[member].empty()) node.erase(member);
}

void check_nodes(const GltfFile& in, const GltfFile& out) {
  const std::size_t count = in.json["nodes"].size();
  for (std::size_t i = 0; i < count; ++i) {
    CAPTURE(i);
    GltfJson before = in.json["nodes"][i], after = out.json["nodes"][i];
    if (before.contains("skin") && after.contains("extensions") && after["extensions"].contains("MSFT_lod"))
      take_out_lod(after);
    if (!before.contains("mesh") || after.contains("mesh")) {
      CHECK(before == after);
      continue;
    }
    const std::size_t child = after["children"].back();
    REQUIRE(child >= count);
    const GltfJson& finest = out.json["nodes"][child];
    after["children"].erase(after["children"].size() - 1);
    if (after["children"].empty()) after.erase("children");
    for (const char* member : {"mesh", "skin", "weights"}) {
      check_equal(before, finest, member);
      before.erase(member);
    }
    CHECK(before == after);
    for (const GltfJson& id : finest["extensions"]["MSFT_lod"]["ids"]) {
      const GltfJson& lower = out.json["nodes"][id.get<std::size_t>()];
      CHECK_FALSE(lower.contains("children"));
      for (const char* member : {"matrix", "translation", "rotation", "scale"}) CHECK_FALSE(lower.contains(member));
      if (lower.contains("mesh")) check_equal(finest, lower, "skin");
    }
  }
}

void check_animations(const GltfFile& in, const GltfFile& out) {
  if (!in.json.contains("animations")) return;
  const std::set<std::size_t> moved = moved_nodes(in, out);
  for (std::size_t a = 0; a < in.json["animations"].size(); ++a) {
    const GltfJson &before = in.json["animations"][a], &after = out.json["animations"][a];
    CHECK(before["samplers"] == after["samplers"]);
    std::size_t added = 0;
    for (std::size_t c = 0; c < before["channels"].size(); ++c) {
      GltfJson expected = before["channels"][c];
      const std::size_t node = expected["target"].value("node", std::size_t{0});
      if (expected["target"]["path"] == "weights" && moved.contains(node)) {
        const std::size_t finest = out.json["nodes"][node]["children"].back();
        expected["target"]["node"] = finest;
        added += out.json["nodes"][finest]["extensions"]["MSFT_lod"]["ids"].size();
      }
      CHECK(expected == after["channels"][c]);
    }
    CHECK(after["channels"].size() == before["channels"].size() + added);
    for (const GltfJson& sampler : before["samplers"])
      for (const char* end : {"input", "output"})
        CHECK(in.accessor_bytes(sampler[end]) == out.accessor_bytes(sampler[end]));
  }
}

void check_images(const GltfFile& in, const GltfFile& out) {
  if (!in.json.contains("images")) return;
  for (std::size_t i = 0; i < in.json["images"].size(); ++i) {
    CHECK(in.image_bytes(i) == out.image_bytes(i));
    GltfJson before = in.json["images"][i], after = out.json["images"][i];
    for (const char* member : {"uri", "bufferView", "mimeType"}) {
      before.erase(member);
      after.erase(member);
    }
    CHECK(before == after);
  }
}

void check_meshes(const GltfFile& in, const GltfFile& out) {
  for (std::size_t i = 0; i < in.json["meshes"].size(); ++i) {
    const GltfJson &before = in.json["meshes"][i], &after = out.json["meshes"][i];
    for (const char* member : {"name", "extras", "weights"}) check_equal(before, after, member);
    REQUIRE(before["primitives"].size() == after["primitives"].size());
    for (std::size_t p = 0; p < before["primitives"].size(); ++p)
      for (const char* member : {"material", "extras"})
        check_equal(before["primitives"][p], after["primitives"][p], member);
  }
}

/// The document's own come first; all others are coarser levels' copies.
void check_materials(const GltfFile& in, const GltfFile& out) {
  const std::size_t count = in.json.contains("materials") ? in.json["materials"].size() : 0;
  for (std::size_t i = 0; i < count; ++i)
    CHECK(unordered(in.json["materials"][i]) == unordered(out.json["materials"][i]));
}

void check_kept(const GltfFile& in, const GltfFile& out) {
  check_materials(in, out);
  for (const char* member : {"textures", "samplers", "cameras", "scenes", "scene", "skins", "extras", "extensions"})
    check_equal(in.json, out.json, member);
  if (in.json.contains("skins"))
    for (const GltfJson& skin : in.json["skins"])
      CHECK(in.accessor_bytes(skin["inverseBindMatrices"]) == out.accessor_bytes(skin["inverseBindMatrices"]));
  check_images(in, out);
  check_nodes(in, out);
  check_meshes(in, out);
  check_animations(in, out);
}

std::vector<std::filesystem::path> scene_files() {
  std::vector<std::filesystem::path> files = mesh_files("gltf");
  for (const auto& file : mesh_files("skin-morph")) files.push_back(file);
  return files;
}

}  // namespace

TEST_CASE("every scene of the models keeps all but its geometry, and its geometry in level 0") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  std::size_t number = 0;
  for (const auto& path : scene_files()) {
    CAPTURE(path);
    const Scene scene = checked(Scene::read(path));
    const std::vector<LeveledMesh> levels = halved(scene);
    const GltfFile in = GltfFile::read(path);
    std::vector<Compression> compressions = {Compression::None, Compression::Draco, Compression::Meshopt};
    if (kReduced) compressions = {compressions[number++ % 3]};
    for (const Compression compression : compressions) {
      AssetOptions options;
      options.compression = compression;
      const EncodedAsset asset = checked(encode_scene(scene, levels, options));
      check_kept(in, GltfFile::from_glb(asset.glb));
      const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
      REQUIRE(again.meshes().size() == scene.meshes().size());
      std::size_t drawn = 0;
      for (const SceneMesh& mesh : scene.meshes()) drawn += mesh.mesh.face_count() * mesh.instance_count;
      CHECK(asset.layout.levels[0].face_count == drawn);
      for (std::size_t i = 0; i < levels.size(); ++i) {
        const Mesh &before = scene.meshes()[i].mesh, &after = again.meshes()[i].mesh;
        CHECK(again.meshes()[i].instance_count == scene.meshes()[i].instance_count);
        CHECK(again.meshes()[i].nodes == scene.meshes()[i].nodes);
        CHECK(again.meshes()[i].materials == scene.meshes()[i].materials);
        if (compression == Compression::None) CHECK(triangle_set(before) == triangle_set(after));
      }
    }
  }
}

TEST_CASE("taking the levels out again gives the document of one level") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  for (const auto& path : scene_files()) {
    CAPTURE(path);
    const Scene scene = checked(Scene::read(path));
    const EncodedAsset asset = checked(encode_scene(scene, halved(scene, 3), plain()));
    const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
    const GltfFile out = GltfFile::from_glb(checked(encode_scene_level(again, halved(again, 1), 0, plain())).glb);
    const GltfFile once = GltfFile::from_glb(checked(encode_scene_level(scene, halved(scene, 1), 0, plain())).glb);
    for (const char* member : {"nodes", "animations", "skins", "materials", "scenes", "extensionsUsed"})
      check_equal(once.json, out.json, member);
    CHECK(once.json["meshes"].size() == out.json["meshes"].size());
  }
}

TEST_CASE("primitives that touch are one mesh, and come apart again with their own members") {
  GltfMaker maker = strips(2, 4);
  maker.add("materials", {{"name", "red"}});
  const std::size_t texcoords = maker.add_floats(std::vector<float>(20, 0.5f), "VEC2", 2);
  GltfJson& primitives = maker.json["meshes"][0]["primitives"];
  primitives[0]["material"] = 0;
  primitives[0]["extensions"]["KHR_materials_variants"] = {{"mappings", {{{"material", 0}, {"variants", {0}}}}}};
  primitives[1]["extras"] = {{"note", 1}};
  primitives[1]["attributes"]["TEXCOORD_0"] = texcoords;
  const GltfJson original = primitives;
  const Scene scene = read(maker);
  REQUIRE(scene.meshes().size() == 1);
  const SceneMesh& mesh = scene.meshes()[0];
  CHECK(mesh.mesh.vertex_count() == 18);  // the two at the border are shared
  CHECK(mesh.mesh.wedge_count() == 20);   // with and without texture coordinates
  CHECK(std::set<Index>(mesh.mesh.face_material.begin(), mesh.mesh.face_material.end()) == std::set<Index>{0, 1});
  CHECK(mesh.materials == std::vector<std::string>{"red", ""});

  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    const GltfFile out = encoded(scene, options);
    const GltfJson& written = out.json["meshes"][0]["primitives"];
    REQUIRE(written.size() == 2);
    CHECK(written[0]["extensions"]["KHR_materials_variants"] == original[0]["extensions"]["KHR_materials_variants"]);
    CHECK(written[0]["material"] == 0);
    CHECK_FALSE(written[0]["attributes"].contains("TEXCOORD_0"));
    CHECK(written[1]["attributes"].contains("TEXCOORD_0"));
    CHECK(written[1]["extras"] == original[1]["extras"]);
    CHECK(faces_of_primitive(out, written[0]) == 8);
    CHECK(out.json["meshes"][1]["name"] == "strips_LOD1");
    CHECK(out.json["meshes"][1]["primitives"].size() == 1);  // half of the faces are those of the first primitive
  }
}

TEST_CASE("instances share their levels' data, and the largest scale counts") {
  GltfMaker maker = strips(1, 4);
  maker.add("nodes", {{"name", "big"}, {"mesh", 0}, {"scale", {1, 3, 2}}, {"extras", {{"tag", 7}}}});
  maker.add("nodes", {{"name", "parent"}, {"translation", {100, 0, 0}}, {"children", {1}}});
  maker.json["scenes"][0]["nodes"] = {0, 2};
  const Scene scene = read(maker);
  REQUIRE(scene.meshes().size() == 1);
  CHECK(scene.meshes()[0].instance_count == 2);
  CHECK(scene.meshes()[0].scale == test::Approx(3));
  CHECK(scene.meshes()[0].area == test::Approx(4 + 12));
  CHECK(scene.meshes()[0].nodes == std::vector<std::string>{"node", "big"});
  CHECK(scene.box().high.x == test::Approx(104));
  CHECK(scene.box().high.y == test::Approx(3));

  const EncodedAsset asset = checked(encode_scene(scene, halved(scene), plain()));
  const GltfFile out = GltfFile::from_glb(asset.glb);
  CHECK(asset.layout.levels[0].face_count == 16);
  CHECK(out.json["meshes"].size() == 1 + 2);
  REQUIRE(out.json["nodes"].size() == 3 + 2 * 2);
  CHECK(out.json["nodes"][1]["extras"] == maker.json["nodes"][1]["extras"]);
  CHECK(out.json["nodes"][1]["scale"] == maker.json["nodes"][1]["scale"]);
  CHECK((*lod_node(out, "big_LOD0"))["mesh"] == 0);
  const auto mesh_at = [&](const char* name) { return out.json["meshes"][(*lod_node(out, name))["mesh"].get<int>()]; };
  CHECK(mesh_at("big_LOD1")["primitives"] == mesh_at("node_LOD1")["primitives"]);
  const auto read_back = checked(checked(Asset::read_bytes(asset.glb)).levels());
  CHECK(read_back[0].mesh.face_count() == 16);
  CHECK(read_back[1].maximum_deviation == test::Approx(0.03));
}

TEST_CASE("levels are measured as clients decode them, attributes and all") {
  const Compression compression = GENERATE(Compression::Draco, Compression::Meshopt);
  constexpr std::size_t kSamples = 1000;
  DeviationOptions few;
  few.sample_count = kSamples;
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const auto assembled = assemble(shape.soup);
    if (assembled->mesh.face_count() == 0) continue;
    const Scene scene = checked(Scene::from_mesh({assembled->mesh, {}, {}, {}, {}}, "shape"));
    AssetOptions options;
    options.compression = compression;
    options.position_bits = 12;
    options.keep_decoded = true;
    const std::vector<LeveledMesh> levels = halved(scene);
    EncodedGeometry geometry = checked(encode_geometry(scene, levels, options));
    REQUIRE(geometry.levels().size() == 1);
    const std::vector<AssetLevel> measured = geometry.levels()[0];
    for (AssetLevel& level : geometry.levels()[0]) level.deviation.backward.maximum = 0.25;
    const EncodedAsset asset = checked(write_asset(std::move(geometry)));
    const auto read_back = checked(checked(Asset::read_bytes(asset.glb)).levels());
    REQUIRE(measured.size() == 2);
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const Mesh& decoded = read_back[i].mesh;
      CHECK(measured[i].mesh.face_count() == decoded.face_count());
      CHECK(measure_deviation(measured[i].mesh, decoded, few).maximum() < 1e-6);
      for (const AttributeDeviation& a : measure_attributes(measured[i].mesh, decoded, kSamples)) CHECK(a.mean < 1e-6);
      CHECK(read_back[i].maximum_deviation == 0.25);
    }
    options.compression = Compression::None;
    EncodedGeometry exact = checked(encode_geometry(scene, levels, options));
    CHECK(exact.levels()[0][0].mesh.positions == scene.meshes()[0].mesh.positions);
  }
}

TEST_CASE("what quantisation leaves no area is measured all the same") {
  // Beside a large shape on one grid, a small one becomes a point.
  GltfMaker maker = strips(1, 4);
  const Scene scene = read(maker);
  AssetOptions options;
  options.compression = GENERATE(Compression::Draco, Compression::Meshopt);
  options.position_bits = 1;
  Mesh small = scene.meshes()[0].mesh;
  for (Vec3f& p : small.positions) p = {p.x * 1e-3F, p.y * 1e-3F, p.z * 1e-3F};
  std::vector<LeveledMesh> meshes = halved(scene);
  meshes[0].levels[1].mesh = small;
  options.keep_decoded = true;
  EncodedGeometry geometry = checked(encode_geometry(scene, meshes, options));
  const Mesh& decoded = geometry.levels()[0][1].mesh;
  CHECK(decoded.face_count() > 0);
  CHECK(bounding_box(decoded).diagonal() == 0);
}

TEST_CASE("levels that repeat the one before share its data, in meshes of their own") {
  GltfMaker maker = strips(1, 4);
  const Scene scene = read(maker);
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    const GltfFile out = encoded(scene, options, 4);
    CHECK(out.json["meshes"].size() == 4);
    const auto primitives = [&](const char* name) {
      return out.json["meshes"][(*lod_node(out, name))["mesh"].get<int>()]["primitives"];
    };
    const auto geometry = [&](const char* name) {
      GltfJson list = primitives(name);
      for (GltfJson& primitive : list) primitive.erase("material");
      return list;
    };
    for (const char* name : {"node_LOD1", "node_LOD2"}) CHECK(geometry(name) == geometry("node_LOD0"));
    CHECK(geometry("node_LOD3") != geometry("node_LOD0"));
  }
}

TEST_CASE("levels without faces have nodes without a mesh, and keep the numbers of others") {
  GltfMaker maker = strips(1, 4);
  const Scene scene = read(maker);
  std::vector<LeveledMesh> levels = halved(scene);
  levels[0].levels[1].mesh = Mesh{};
  levels[0].levels[1].mesh.attributes = levels[0].levels[0].mesh.attributes;
  const GltfFile out = GltfFile::from_glb(checked(encode_scene(scene, levels, plain())).glb);
  CHECK_FALSE(lod_node(out, "node_LOD1")->contains("mesh"));
  const GltfFile file = GltfFile::from_glb(checked(encode_scene_level(scene, levels, 1, plain())).glb);
  CHECK_FALSE(file.json["nodes"][0].contains("mesh"));
  CHECK(file.json["meshes"].size() == 1);
}

TEST_CASE("points stay as they are, at every level") {
  GltfMaker maker = strips(1, 4);
  const GltfJson points = {{"mode", 0},
                           {"attributes", {{"POSITION", maker.add_floats({0, 0, 5, 1, 0, 5}, "VEC3", 3)}}}};
  maker.json["meshes"][0]["primitives"].insert(maker.json["meshes"][0]["primitives"].begin(), points);
  const Scene scene = read(maker);
  for (const Index material : scene.meshes().at(0).mesh.face_material) CHECK(material == 1);
  const GltfFile out = encoded(scene, {});
  for (const std::size_t mesh : {0, 1}) {
    REQUIRE(out.json["meshes"][mesh]["primitives"].size() == 2);
    GltfJson kept = out.json["meshes"][mesh]["primitives"][0];
    if (mesh > 0) kept.erase("material");
    CHECK(kept == points);
  }
  const std::size_t accessor = points["attributes"]["POSITION"];
  CHECK(out.accessor_bytes(accessor) == GltfFile::from_glb(maker.glb()).accessor_bytes(accessor));
}

namespace {

/// Adds morph targets to the first primitive of `strips(1, 4)`: one plain, one sparse without a bufferView.
void add_targets(GltfMaker& maker) {
  std::vector<float> up;
  for (int i = 0; i < 10; ++i) up.insert(up.end(), {0, 0, static_cast<float>(i)});
  const std::size_t plain_target = maker.add_floats(up, "VEC3", 3);
  maker.json["accessors"][plain_target]["min"] = {0, 0, 0};
  maker.json["accessors"][plain_target]["max"] = {0, 0, 9};
  const std::size_t indices = maker.add_view(std::vector<std::uint16_t>{2, 7});
  const std::size_t values = maker.add_view(std::vector<float>{1, 2, 3, 4, 5, 6});
  GltfJson sparse = {{"componentType", 5126},
                     {"count", 10},
                     {"type", "VEC3"},
                     {"min", {0, 0, 0}},
                     {"max", {4, 5, 6}},
                     {"sparse",
                      {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                       {"values", {{"bufferView", values}}}}}};
  const std::size_t sparse_target = maker.add("accessors", sparse);
  maker.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", plain_target}}, {{"POSITION", sparse_target}}};
  maker.json["meshes"][0]["weights"] = {0.5, 0.25};
  maker.json["nodes"][0]["weights"] = {0.25, 0.5};
}

void add_weights_animation(GltfMaker& maker) {
  const std::size_t times = maker.add_floats({0, 1}, "SCALAR", 1);
  const std::size_t weights = maker.add_floats({0, 1, 1, 0}, "SCALAR", 1);
  const GltfJson pointer = {{"path", "pointer"},
                            {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/0/weights/1"}}}}}};
  maker.add("animations", {{"samplers", {{{"input", times}, {"output", weights}}}},
                           {"channels",
                            {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}},
                             {{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
                             {{"sampler", 0}, {"target", pointer}}}}});
}

/// The position of every corner with its deltas, by target; what belongs together must stay together.
std::multiset<std::vector<float>> morphed_corners(const GltfFile& file, const GltfJson& primitive,
                                                  const std::vector<float>& positions) {
  std::multiset<std::vector<float>> corners;
  const auto floats = [&](std::size_t accessor) {
    const ByteVector bytes = file.accessor_bytes(accessor);
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  };
  const std::vector<float> first = floats(primitive["targets"][0]["POSITION"]);
  const std::vector<float> second = floats(primitive["targets"][1]["POSITION"]);
  for (std::size_t i = 0; i < positions.size(); i += 3)
    corners.insert({positions[i], positions[i + 1], first[i + 2], second[i], second[i + 1], second[i + 2]});
  return corners;
}

}  // namespace

TEST_CASE("morph targets, sparse ones too, stay with their vertices") {
  GltfMaker maker = strips(1, 4);
  add_targets(maker);
  add_weights_animation(maker);
  const Scene scene = read(maker);
  const SceneMesh& mesh = scene.meshes().at(0);
  CHECK(mesh.has_targets);
  std::set<std::string> names;
  for (const Attribute& a : mesh.mesh.attributes) names.insert(a.name);
  CHECK(names == std::set<std::string>{"TARGET_0:POSITION", "TARGET_1:POSITION"});

  std::multiset<std::vector<float>> expected;
  for (int i = 0; i < 10; ++i) {
    const int column = i / 2;
    std::vector<float> corner = {static_cast<float>(column), static_cast<float>(i % 2), static_cast<float>(i), 0, 0, 0};
    if (i == 2) corner = {1, 0, 2, 1, 2, 3};
    if (i == 7) corner = {3, 1, 7, 4, 5, 6};
    expected.insert(corner);
  }
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    options.position_bits = 8;  // steps of 4/255, which is why positions are rounded below
    const EncodedAsset asset = checked(encode_scene(scene, halved(scene), options));
    const GltfFile out = GltfFile::from_glb(asset.glb);
    const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
    REQUIRE(again.meshes().at(0).mesh.wedge_count() == 10);
    const Mesh& decoded = again.meshes()[0].mesh;
    std::multiset<std::vector<float>> corners;
    for (std::size_t w = 0; w < 10; ++w) {
      const Vec3f p = decoded.positions[decoded.wedge_vertex[w]];
      Vec3f first, second;
      for (const Attribute& a : decoded.attributes)
        std::memcpy(a.name == "TARGET_0:POSITION" ? &first : &second, a.data.data() + w * sizeof(Vec3f), sizeof(Vec3f));
      corners.insert({std::round(p.x), std::round(p.y), first.z, second.x, second.y, second.z});
    }
    CHECK(corners == expected);
    if (compression == Compression::None) {
      const ByteVector bytes = out.accessor_bytes(out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]);
      std::vector<float> positions(bytes.size() / sizeof(float));
      std::memcpy(positions.data(), bytes.data(), bytes.size());
      CHECK(morphed_corners(out, out.json["meshes"][0]["primitives"][0], positions) == expected);
    }
    CHECK(out.json["meshes"][0]["primitives"][0].contains("extensions") == (compression == Compression::Draco));
    CHECK(out.json["meshes"][1]["weights"] == maker.json["meshes"][0]["weights"]);
    CHECK((*lod_node(out, "node_LOD1"))["weights"] == maker.json["nodes"][0]["weights"]);
    check_nodes(GltfFile::from_glb(maker.glb()), out);
  }
}

TEST_CASE("animations of weights move every level's node, others stay") {
  GltfMaker maker = strips(1, 4);
  add_targets(maker);
  add_weights_animation(maker);
  const Scene scene = read(maker);
  const GltfFile out = encoded(scene, {}, 3);
  const GltfJson& channels = out.json["animations"][0]["channels"];
  REQUIRE(channels.size() == 3 + 2 * 2);
  CHECK(channels[0]["target"]["node"] == 1);
  CHECK(channels[1] == maker.json["animations"][0]["channels"][1]);
  const auto pointer = [&](std::size_t i) {
    return channels[i]["target"]["extensions"]["KHR_animation_pointer"]["pointer"].get<std::string>();
  };
  CHECK(pointer(2) == "/nodes/1/weights/1");
  CHECK(channels[3]["target"]["node"] == 2);
  CHECK(channels[4]["target"]["node"] == 3);
  CHECK(pointer(5) == "/nodes/2/weights/1");
  CHECK(pointer(6) == "/nodes/3/weights/1");
}

/// The pointers of an animation's channels, sorted.
std::vector<std::string> pointers_of(const GltfFile& file) {
  std::vector<std::string> pointers;
  for (const GltfJson& channel : file.json["animations"][0]["channels"])
    pointers.push_back(channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"]);
  std::sort(pointers.begin(), pointers.end());
  return pointers;
}

TEST_CASE("animation pointers reach all that a mesh, a primitive or a material has become, and come back") {
  GltfMaker maker = strips(2, 4);
  add_targets(maker);
  maker.add("materials", {{"name", "first"}});
  for (int i = 0; i < 2; ++i) maker.json["meshes"][0]["primitives"][i]["material"] = 0;
  const std::size_t times = maker.add_floats({0, 1}, "SCALAR", 1), values = maker.add_floats({0, 1}, "SCALAR", 1);
  const std::vector<std::string> before = {
      "/materials/0/emissiveFactor", "/meshes/0/extras/a", "/meshes/0/primitives/1/extras/b",
      "/meshes/0/weights/0",         "/nodes/0/scale",     "/nodes/0/weights"};
  GltfJson channels = GltfJson::array();
  for (const std::string& pointer : before)
    channels.push_back(
        {{"sampler", 0},
         {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
  maker.add("animations", {{"samplers", {{{"input", times}, {"output", values}}}}, {"channels", channels}});
  const Scene scene = read(maker);
  // The coarse level has lost the first primitive.
  std::vector<LeveledMesh> levels = halved(scene);
  Mesh& coarse = levels[0].levels[1].mesh;
  coarse = scene.meshes()[0].mesh;
  coarse.corner_wedge.erase(coarse.corner_wedge.begin(), coarse.corner_wedge.begin() + 3 * 8);
  coarse.face_material.erase(coarse.face_material.begin(), coarse.face_material.begin() + 8);
  const EncodedAsset asset = checked(encode_scene(scene, levels, plain()));
  const std::vector<std::string> after = {"/materials/0/emissiveFactor",
                                          "/materials/1/emissiveFactor",
                                          "/meshes/0/extras/a",
                                          "/meshes/0/primitives/1/extras/b",
                                          "/meshes/0/weights/0",
                                          "/meshes/1/extras/a",
                                          "/meshes/1/primitives/0/extras/b",
                                          "/meshes/1/weights/0",
                                          "/nodes/0/scale",
                                          "/nodes/1/weights",
                                          "/nodes/2/weights"};
  CHECK(pointers_of(GltfFile::from_glb(asset.glb)) == after);
  const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
  CHECK(pointers_of(GltfFile::from_glb(checked(encode_scene_level(again, halved(again, 1), 0, plain())).glb)) ==
        before);
}

/// Two nodes that show one mesh of a strip of 4 × 1, so far apart and so large, below one node or as roots.
GltfMaker two_strips(double apart, double scale, bool one_root) {
  GltfMaker maker = strips(1, 4);
  maker.add("nodes",
            {{"name", "other"}, {"mesh", 0}, {"translation", {apart, 0, 0}}, {"scale", {scale, scale, scale}}});
  maker.json["scenes"][0]["nodes"] = {0, 1};
  if (!one_root) return maker;
  maker.add("nodes", {{"name", "root"}, {"children", {0, 1}}});
  maker.json["scenes"][0]["nodes"] = {2};
  return maker;
}

/// MSFT_screencoverage of both nodes.
std::pair<GltfJson, GltfJson> coverages(GltfMaker maker) {
  const Scene scene = read(maker);
  std::vector<LeveledMesh> levels = halved(scene, 3);
  for (const std::size_t level : {1, 2})
    levels[0].levels[level].deviation.forward.rms = 0.01 * static_cast<double>(level);
  const GltfFile out = GltfFile::from_glb(checked(encode_scene(scene, levels, {})).glb);
  const auto of = [&](const char* name) { return (*lod_node(out, name))["extras"]["MSFT_screencoverage"]; };
  return {of("node_LOD0"), of("other_LOD0")};
}

TEST_CASE("parts of one object change their level together, objects each by itself") {
  for (const bool one_root : {false, true}) {
    const auto [touching, touched] = coverages(two_strips(4, 1, one_root));
    CHECK(touching == touched);
  }
  const auto [near, far] = coverages(two_strips(100, 1, true));
  CHECK(near == far);
  const auto [alone, other] = coverages(two_strips(100, 2, false));
  CHECK(alone != near);
  const auto [house, ground] = coverages(two_strips(0, 100, false));
  CHECK(house == alone);
}

TEST_CASE("each level has materials of its own, variants' too, and the same textures in them") {
  GltfMaker maker = strips(2, 4);
  maker.add("materials", {{"name", "first"}, {"normalTexture", {{"index", 0}}}});
  maker.add("materials", {{"name", "other"}});
  GltfJson& primitive = maker.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
  const Scene scene = read(maker);
  const EncodedAsset asset = checked(encode_scene(scene, halved(scene, 3), {}));
  const GltfFile out = GltfFile::from_glb(asset.glb);
  std::set<std::size_t> seen;
  for (const GltfJson& mesh : out.json["meshes"]) {
    const GltfJson& named = mesh["primitives"][0];
    const std::size_t first = named["material"];
    const std::size_t other = named["extensions"]["KHR_materials_variants"]["mappings"][0]["material"];
    CHECK(out.json["materials"][first] == maker.json["materials"][0]);
    CHECK(out.json["materials"][other] == maker.json["materials"][1]);
    CHECK((seen.insert(first).second && seen.insert(other).second));
    // The default material, too, would be thrown away with a level.
    if (mesh["primitives"].size() < 2 || !mesh["primitives"][1].contains("material")) continue;
    const std::size_t plain_one = mesh["primitives"][1]["material"];
    CHECK((out.json["materials"][plain_one] == GltfJson::object() && seen.insert(plain_one).second));
  }
  const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
  const GltfFile back = GltfFile::from_glb(checked(encode_scene_level(again, halved(again, 1), 0, plain())).glb);
  CHECK(back.json["materials"] == maker.json["materials"]);
}

TEST_CASE("a skinned mesh has the scale and the box of its pose at rest") {
  GltfMaker maker = strips(1, 4);
  std::vector<std::uint8_t> joints(40);
  std::vector<float> weights(40);
  for (std::size_t i = 0; i < 10; ++i) {
    joints[4 * i] = i < 6 ? 0 : 1;
    weights[4 * i] = 1;
  }
  const std::size_t joint_accessor = maker.add_accessor(joints, 5121, "VEC4", 4);
  const std::size_t weight_accessor = maker.add_floats(weights, "VEC4", 4);
  GltfJson& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = joint_accessor;
  attributes["WEIGHTS_0"] = weight_accessor;
  const std::vector<float> half = {.5, 0, 0, 0, 0, .5, 0, 0, 0, 0, .5, 0, 0, 0, 0, 1};
  std::vector<float> matrices = half;
  matrices.insert(matrices.end(), half.begin(), half.end());
  const std::size_t inverse = maker.add_floats(matrices, "MAT4", 16);
  maker.add("nodes", {{"name", "joint"}});
  maker.add("nodes", {{"name", "other joint"}, {"scale", {4, 4, 4}}, {"translation", {0, 0, 7}}});
  maker.json["scenes"][0]["nodes"] = {0, 1, 2};
  maker.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse}});
  maker.json["nodes"][0]["skin"] = 0;
  maker.json["nodes"][0]["translation"] = {1000, 0, 0};  // without effect on what is skinned
  const Scene scene = read(maker);
  const SceneMesh& mesh = scene.meshes().at(0);
  CHECK(mesh.skinned);
  CHECK(mesh.scale == test::Approx(2));
  CHECK(scene.box().low.z == test::Approx(0));
  CHECK(scene.box().high.z == test::Approx(7));
  CHECK(scene.box().high.x == test::Approx(8));

  const EncodedAsset asset = checked(encode_scene(scene, halved(scene), {}));
  const GltfFile out = GltfFile::from_glb(asset.glb);
  check_kept(GltfFile::from_glb(maker.glb()), out);
  CHECK((*lod_node(out, "node_LOD1"))["skin"] == 0);
  // It was a root, and so it stays one: glTF warns of others.
  CHECK((out.json["nodes"][0]["mesh"] == 0 && out.json["nodes"][0]["extensions"].contains("MSFT_lod")));
  const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
  const GltfFile back = GltfFile::from_glb(checked(encode_scene_level(again, halved(again, 1), 0, plain())).glb);
  check_equal(maker.json, back.json, "nodes");
  for (const Attribute& a : again.meshes().at(0).mesh.attributes)
    if (a.name == "JOINTS_0") CHECK(a.type == ComponentType::UInt8);
}

TEST_CASE("unknown extensions and extras stay, and what they may name keeps its number") {
  GltfMaker maker = strips(1, 4);
  const std::size_t secret = maker.add_floats({1, 2, 3}, "SCALAR", 1);
  const std::size_t view = maker.add_view(std::vector<std::uint8_t>{9, 8, 7});
  const GltfJson unknown = {{"EXT_unknown", {{"accessor", secret}, {"bufferView", view}}}};
  maker.json["extensionsUsed"] = {"EXT_unknown"};
  maker.json["extensions"] = unknown;
  maker.json["extras"] = {{"a", {1, 2}}};
  maker.json["asset"]["copyright"] = "me";
  maker.json["asset"]["extras"] = 5;
  maker.json["scenes"][0]["extensions"] = unknown;
  maker.json["nodes"][0]["extensions"] = unknown;
  maker.json["nodes"][0]["extras"] = "node";
  maker.json["meshes"][0]["extensions"] = unknown;
  maker.json["meshes"][0]["extras"] = "mesh";
  maker.json["meshes"][0]["primitives"][0]["extensions"] = unknown;
  maker.add("odd", {{"thing", 1}});
  const GltfFile in = GltfFile::from_glb(maker.glb());
  const Scene scene = read(maker);
  for (const Compression compression : {Compression::None, Compression::Draco, Compression::Meshopt}) {
    AssetOptions options;
    options.compression = compression;
    const GltfFile out = encoded(scene, options);
    check_kept(in, out);
    check_equal(in.json, out.json, "odd");
    CHECK(out.json["asset"]["copyright"] == "me");
    CHECK(out.json["asset"]["extras"] == 5);
    CHECK(out.json["asset"]["generator"].get<std::string>().starts_with("lodestone"));
    CHECK(out.json["extensionsUsed"][0] == "EXT_unknown");
    CHECK(out.accessor_bytes(secret) == in.accessor_bytes(secret));
    CHECK(out.view_bytes(view) == in.view_bytes(view));
    for (const GltfJson& mesh : out.json["meshes"]) {
      CHECK(mesh["extensions"]["EXT_unknown"] == unknown["EXT_unknown"]);
      CHECK(mesh["extras"] == "mesh");
      CHECK(mesh["primitives"][0]["extensions"]["EXT_unknown"] == unknown["EXT_unknown"]);
    }
    if (out.json.contains("extensionsRequired"))
      for (const GltfJson& name : out.json["extensionsRequired"]) CHECK(name != "MSFT_lod");
  }
}

TEST_CASE("meshes that nothing shows stay as they are, compressed ones too") {
  GltfMaker maker = strips(1, 4);
  GltfJson spare = strip_primitive(maker, 50, 2);
  maker.add("meshes", {{"name", "spare"}, {"primitives", GltfJson::array({spare})}});
  maker.add("nodes", {{"name", "nowhere"}, {"mesh", 1}});
  const Scene scene = read(maker);
  CHECK(scene.meshes().size() == 1);
  const GltfFile in = GltfFile::from_glb(maker.glb()), out = encoded(scene, {});
  CHECK(out.json["meshes"][1] == in.json["meshes"][1]);
  CHECK(out.json["nodes"][1] == in.json["nodes"][1]);
  CHECK(out.accessor_bytes(spare["indices"]) == in.accessor_bytes(spare["indices"]));
}

TEST_CASE("instancing counts, and every level has it") {
  GltfMaker maker = strips(1, 4);
  const std::size_t moves = maker.add_floats({0, 0, 0, 0, 10, 0, 0, 20, 0}, "VEC3", 3);
  const std::size_t scales = maker.add_floats({1, 1, 1, 2, 2, 2, 5, 5, 5}, "VEC3", 3);
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {
      {"attributes", {{"TRANSLATION", moves}, {"SCALE", scales}}}};
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = read(maker);
  CHECK(scene.meshes().at(0).instance_count == 3);
  CHECK(scene.meshes()[0].scale == test::Approx(5));
  CHECK(scene.box().high.y == test::Approx(25));
  const GltfFile out = encoded(scene, plain());
  CHECK_FALSE(out.json["nodes"][0].contains("extensions"));
  for (const char* name : {"node_LOD0", "node_LOD1"})
    CHECK((*lod_node(out, name))["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] == scales);
  CHECK(out.accessor_bytes(scales) == GltfFile::from_glb(maker.glb()).accessor_bytes(scales));
}

TEST_CASE("images come into the file, and those that are missing are noted") {
  const ScratchDirectory folder;
  GltfMaker maker = strips(1, 4);
  const std::string jpeg = "\xff\xd8\xff\xe0 picture";
  REQUIRE(write_file(folder / "a b.dat", std::as_bytes(std::span(jpeg))));
  maker.add("images", {{"uri", "a%20b.dat"}, {"name", "beside"}});
  maker.add("images", {{"uri", "data:image/png;base64,iVBORw0KGgoAAAA="}});
  maker.add("images", {{"uri", "missing.png"}});
  REQUIRE(write_file(folder / "in.glb", maker.glb()));
  const Scene scene = checked(Scene::read(folder / "in.glb"));
  REQUIRE(scene.notes().size() == 1);
  CHECK_THAT(scene.notes()[0], contains("image 2") && contains("missing.png"));
  const GltfFile out = encoded(scene, {});
  const ByteVector bytes = out.image_bytes(0);
  CHECK(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()) == jpeg);
  CHECK(out.json["images"][0]["mimeType"] == "image/jpeg");
  CHECK(out.json["images"][0]["name"] == "beside");
  CHECK(out.image_bytes(1).size() == 11);
  CHECK(out.json["images"][1]["mimeType"] == "image/png");
  CHECK(out.json["images"][2] == GltfJson{{"uri", "missing.png"}});
}

TEST_CASE("images of every kind come into the file under its type, others stay where they were") {
  const std::pair<std::string, std::string> kinds[] = {
      {"iVBORw0KGgoAAAA=", "image/png"},          {"/9j/4AA=", "image/jpeg"},
      {"UklGRiQAAABXRUJQVlA4IA==", "image/webp"}, {"q0tUWCAyMLsNChoKAAAA", "image/ktx2"},
      {"AAAAIGZ0eXBhdmlmAAA=", "image/avif"},     {"RERTIHwAAAA=", "image/vnd-ms.dds"}};
  GltfMaker maker = strips(1, 4);
  for (const auto& [content, type] : kinds)
    maker.add("images", {{"uri", "data:application/octet-stream;base64," + content}});
  const std::string unknown = "data:application/octet-stream;base64,AAAA";
  maker.add("images", {{"uri", unknown}});
  const Scene scene = read(maker);
  const GltfFile out = encoded(scene, {});
  for (std::size_t i = 0; i < std::size(kinds); ++i) {
    CHECK(out.json["images"][i]["mimeType"] == kinds[i].second);
    CHECK(out.image_bytes(i) == decode_base64(kinds[i].first));
  }
  CHECK(out.json["images"].back() == GltfJson{{"uri", unknown}});
  REQUIRE(scene.notes().size() == 1);
  CHECK_THAT(scene.notes()[0], contains("image 6 stays outside the file"));
}

TEST_CASE("meshes of equal scale share one grid, so that equal places decode to equal places") {
  GltfMaker maker = strips(1, 7);
  GltfJson other = strip_primitive(maker, 7, 13);
  maker.add("meshes", {{"name", "other"}, {"primitives", GltfJson::array({other})}});
  maker.add("nodes", {{"name", "second"}, {"mesh", 1}});
  maker.json["scenes"][0]["nodes"] = {0, 1};
  AssetOptions options;
  options.position_bits = 9;
  const Scene scene = read(maker);
  const EncodedAsset asset = checked(encode_scene(scene, halved(scene), options));
  const Scene again = checked(checked(Asset::read_bytes(asset.glb)).scene());
  float left_end = -1, right_begin = 100;
  for (const Vec3f& p : again.meshes().at(0).mesh.positions) left_end = std::max(left_end, p.x);
  for (const Vec3f& p : again.meshes().at(1).mesh.positions) right_begin = std::min(right_begin, p.x);
  CHECK(left_end == right_begin);
}

TEST_CASE("the coarsest level comes first, then what is kept, the finer levels, and streams last") {
  GltfMaker maker = strips(2, 8);
  maker.add("images", {{"mimeType", "image/png"}, {"bufferView", maker.add_view(std::vector<std::uint8_t>(100, 42))}});
  const Scene scene = read(maker);
  std::vector<LeveledMesh> levels = halved(scene, 2);
  levels[0].stream.assign(64, std::byte{7});
  const EncodedAsset asset = checked(encode_scene(scene, levels, plain()));
  const GltfFile out = GltfFile::from_glb(asset.glb);
  const auto& layout = asset.layout.levels;
  const std::size_t image =
      out.json["bufferViews"][out.json["images"][0]["bufferView"].get<std::size_t>()]["byteOffset"];
  CHECK(layout[1].byte_offset == 0);
  CHECK(image >= layout[1].byte_length);
  CHECK(layout[0].byte_offset >= image + 100);
  const GltfJson& stream = out.json["meshes"][0]["extensions"]["LODESTONE_removal_stream"];
  const GltfJson& view = out.json["bufferViews"][stream["bufferView"].get<std::size_t>()];
  CHECK(view["byteOffset"].get<std::size_t>() >= layout[0].byte_offset + layout[0].byte_length);
  CHECK(view["byteOffset"].get<std::size_t>() + 64 == out.json["buffers"][0]["byteLength"].get<std::size_t>());
}

TEST_CASE("files with levels already are refused, and those of other programs are not taken apart") {
  GltfMaker maker = strips(1, 4);
  maker.add("nodes", {{"mesh", 0}});
  maker.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {1};
  CHECK(error_of(maker) == "node 0 already has levels of detail (MSFT_lod); build from the original");
  const Asset asset = checked(Asset::read_bytes(maker.glb()));
  CHECK(asset.level_count() == 2);
  const auto scene = asset.scene();
  REQUIRE_FALSE(scene);
  CHECK(scene.error().code == ErrorCode::Unsupported);
}

TEST_CASE("attributes of a type that vertices may not have are left out, with a note") {
  GltfMaker maker = strips(1, 4);
  const std::size_t ids = maker.add_accessor(std::vector<std::uint32_t>(10, 3), 5125, "SCALAR", 1);
  maker.json["meshes"][0]["primitives"][0]["attributes"]["_ID"] = ids;
  const Scene scene = read(maker);
  REQUIRE(scene.notes().size() == 1);
  CHECK_THAT(scene.notes()[0], contains("mesh 0: attribute _ID is left out"));
  CHECK_FALSE(encoded(scene, {}).json["meshes"][0]["primitives"][0]["attributes"].contains("_ID"));
}

TEST_CASE("broken scenes are errors that name what is broken") {
  struct Breakage {
    const char* pointer;
    GltfJson value;
    const char* message;
  };
  const std::vector<Breakage> breakages = {
      {"/nodes/0/mesh", 7, "mesh 7 does not exist"},
      {"/nodes/0/mesh", -1, "mesh is -1"},
      {"/nodes/0/children", {0}, "own ancestor"},
      {"/nodes/0/skin", 3, "skin 3 does not exist"},
      {"/scenes/0/nodes/0", 9, "node 9 does not exist"},
      {"/meshes/0/primitives/0/targets", 5, "targets is not an array"},
      {"/meshes/0/primitives/0/targets/0", 5, "is not an object"},
      {"/meshes/0/primitives/0/targets/0/POSITION", 99, "accessor 99 does not exist"},
      {"/meshes/0/primitives/0/targets/0/POSITION", 1, "elements for"},
      {"/accessors/3/sparse/count", 11, "sparse"},
      {"/accessors/3/sparse/indices/bufferView", 50, "buffer view 50"},
      {"/bufferViews/0/byteLength", 1e9, "exceed"},
      {"/meshes/0/primitives/0/attributes/POSITION", 1, "POSITION has 1 components"},
  };
  for (const Breakage& breakage : breakages) {
    CAPTURE(breakage.pointer);
    GltfMaker maker = strips(1, 4);
    add_targets(maker);
    maker.json[GltfJson::json_pointer(breakage.pointer)] = breakage.value;
    CHECK_THAT(error_of(maker), contains(breakage.message));
  }
}

TEST_CASE("a file that lacks any of its lists is read, or refused with words") {
  GltfMaker maker = strips(2, 4);
  const GltfFile whole = encoded(read(maker), plain());
  for (const auto& [list, value] : whole.json.items()) {
    CAPTURE(list);
    GltfMaker broken;
    broken.binary = whole.buffers[0];
    broken.json = whole.json;
    broken.json.erase(list);
    const ByteVector bytes = broken.glb();
    const auto of_level = Asset::read_bytes(bytes).and_then([](const Asset& asset) { return asset.scene(); });
    for (const auto& scene : {of_level, Scene::read_bytes(bytes, "glb")})
      CHECK((scene || !scene.error().message.empty()));
  }
}

TEST_CASE("levels that do not fit the scene are refused") {
  GltfMaker maker = strips(2, 4);
  const Scene scene = read(maker);
  std::vector<LeveledMesh> levels = halved(scene);
  levels[0].levels[1].mesh.face_material[0] = 5;
  const auto wrong_material = encode_scene(scene, levels, {});
  REQUIRE_FALSE(wrong_material);
  CHECK(wrong_material.error().code == ErrorCode::InvalidArgument);
  CHECK_FALSE(encode_scene(scene, {}, {}));
  CHECK_FALSE(encode_scene_level(scene, halved(scene), 2, {}));
}

}  // namespace lodestone::test

// What read_mesh promises for glTF: everything a file says is checked against what is really there.

#include <cstring>
#include <fstream>
#include <string>

#include <lodestone/core/validate.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>

#include "support/data.h"
#include "support/gltf_shapes.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

std::string glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  std::string out;
  put(out, std::uint32_t{0x46546C67});
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(28 + json.size() + binary.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  put(out, std::uint32_t{0x4E4F534A});
  out += json;
  put(out, static_cast<std::uint32_t>(binary.size()));
  put(out, std::uint32_t{0x004E4942});
  return out + binary;
}

/// Four points of a square, then the indices 0 1 2 0 2 3 in 16 bits.
std::string square_binary() {
  std::string out;
  for (const float f : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F}) put(out, f);
  for (const int i : {0, 1, 2, 0, 2, 3}) put(out, static_cast<std::uint16_t>(i));
  return out;
}

/// The parts of a document with one square; tests replace one of them.
struct Square {
  std::string nodes = R"([{"mesh":0}])";
  std::string primitive = R"("attributes":{"POSITION":0},"indices":1)";
  std::string positions = R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3")";
  std::string indices = R"("bufferView":1,"componentType":5123,"count":6,"type":"SCALAR")";
  std::string views = R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12})";
  std::string buffers = R"([{"byteLength":60}])";
  std::string more;
  std::string binary = square_binary();

  std::string file() const {
    return glb(R"({"asset":{"version":"2.0"},"nodes":)" + nodes + R"(,"meshes":[{"primitives":[{)" + primitive +
                   R"(}]}],"accessors":[{)" + positions + "},{" + indices + R"(}],"bufferViews":[)" + views +
                   R"(],"buffers":)" + buffers + more + "}",
               binary);
  }
};

MeshFile read(const std::string& source) {
  auto file = read_mesh_bytes(std::as_bytes(std::span(source)), "gltf");
  INFO((file ? std::string() : file.error().message));
  REQUIRE(file);
  return std::move(*file);
}

MeshFile read(const Square& square) { return read(square.file()); }

void check_fails(const Square& square, const std::string& message, ErrorCode code = ErrorCode::Malformed) {
  const std::string source = square.file();
  const auto file = read_mesh_bytes(std::as_bytes(std::span(source)), "gltf");
  INFO(message);
  REQUIRE_FALSE(file);
  CHECK_THAT(file.error().message, contains(message));
  CHECK(file.error().code == code);
}

}  // namespace

TEST_CASE("gltf: a plain document reads as it stands") {
  const MeshFile file = read(Square{});
  CHECK(file.mesh.vertex_count() == 4);
  CHECK(file.mesh.face_count() == 2);
  CHECK(file.notes.empty());
  CHECK(surface_area(file.mesh) == Approx(1));
}

TEST_CASE("gltf: counts, offsets and strides must fit the bytes that are there") {
  Square square;
  square.positions = R"("bufferView":0,"componentType":5126,"count":70000,"type":"VEC3")";
  check_fails(square, "accessor 0: count 70000 from byte 0 exceeds buffer view of 48 bytes");
  square.positions = R"("bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"VEC3")";
  check_fails(square, "exceeds buffer view");
  square.positions = R"("bufferView":0,"byteOffset":18446744073709551612,"componentType":5126,"count":4,"type":"VEC3")";
  check_fails(square, "exceeds buffer view");
  square.positions = R"("bufferView":9,"componentType":5126,"count":4,"type":"VEC3")";
  check_fails(square, "buffer view 9 does not exist: the file has 2");
  square.positions = R"("bufferView":0,"componentType":5126,"count":-4,"type":"VEC3")";
  check_fails(square, "accessor 0: count is -4 and not a whole number");
  square.positions = R"("bufferView":0,"componentType":5130,"count":4,"type":"VEC3")";
  check_fails(square, "accessor 0: componentType 5130");
  square.positions = R"("componentType":5126,"count":4000000000,"type":"VEC3")";
  check_fails(square, "accessor 0: count 4000000000 without a buffer view", ErrorCode::LimitExceeded);
  square = {};
  square.views = R"({"buffer":0,"byteLength":48,"byteStride":4},{"buffer":0,"byteOffset":48,"byteLength":12})";
  check_fails(square, "accessor 0: elements of 12 bytes in a stride of 4");
  square.views = R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":999})";
  check_fails(square, "buffer view 1: 999 bytes from 48 exceed buffer 0 of 60 bytes");
  square.views = R"({"buffer":3,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12})";
  check_fails(square, "buffer view 0: buffer 3 does not exist: the file has 1");
  square = {};
  square.buffers = R"([{"byteLength":61}])";
  check_fails(square, "buffer 0: byteLength 61 where there are 60 bytes");
}

TEST_CASE("gltf: references and indices out of range are errors") {
  Square square;
  square.binary[48] = 4;
  check_fails(square, "mesh 0 primitive 0: index 0 is 4: there are 4 vertices");
  square.binary[48] = square.binary[49] = '\xff';
  check_fails(square, "index 0 is 65535, the primitive restart value");
  square = {};
  square.nodes = R"([{"mesh":7}])";
  check_fails(square, "mesh 7 does not exist: the file has 1");
  square.nodes = R"([{"mesh":0,"children":[5]}])";
  check_fails(square, "node 0: node 5 does not exist: the file has 1");
  square = {};
  square.primitive = R"("attributes":{"POSITION":0},"indices":1,"material":3)";
  check_fails(square, "material 3 does not exist");
  square.primitive = R"("indices":1)";
  check_fails(square, "has no POSITION");
  square.primitive = R"("attributes":{"POSITION":0},"indices":1,"mode":9)";
  check_fails(square, "mode 9");
  square.primitive = R"("attributes":{"POSITION":0,"NORMAL":1},"indices":1)";
  check_fails(square, "NORMAL has 6 elements for 4 positions");
}

TEST_CASE("gltf: node graphs that are no trees are errors") {
  Square square;
  square.nodes = R"([{"children":[1]},{"mesh":0,"children":[0]}])";
  check_fails(square, "is its own ancestor");
  square.nodes = R"([{"children":[0],"mesh":0}])";
  check_fails(square, "is its own ancestor");
  square.nodes = R"([{"children":[2]},{"children":[2]},{"mesh":0}])";
  check_fails(square, "node 2: has two parents");
  square.nodes = R"([{"mesh":0},{"mesh":0}])";
  square.more = R"(,"scenes":[{"nodes":[1,1]}])";
  check_fails(square, "node 1: stands in the scene twice");
  square.more = R"(,"scenes":[{"nodes":[2]}])";
  check_fails(square, "scene 0: node 2 does not exist");
  square.more = R"(,"scene":4,"scenes":[{"nodes":[0]}])";
  check_fails(square, "scene 4 does not exist");
}

TEST_CASE("gltf: a chain of nodes may be as deep as it likes") {
  Square square;
  square.nodes = "[";
  constexpr int kDepth = 20000;
  for (int i = 0; i < kDepth; ++i) square.nodes += R"({"children":[)" + std::to_string(i + 1) + "]},";
  square.nodes += R"({"mesh":0}])";
  CHECK(read(square).mesh.face_count() == 2);
}

TEST_CASE("gltf: broken containers are errors") {
  const std::string whole = Square{}.file();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto file = read_mesh_bytes(std::as_bytes(std::span(whole).first(size)), "glb");
    REQUIRE_FALSE(file);
    CHECK_FALSE(file.error().message.empty());
  }
  std::string version = whole;
  version[4] = 1;
  const auto old = read_mesh_bytes(std::as_bytes(std::span(version)), "glb");
  REQUIRE_FALSE(old);
  CHECK(old.error().code == ErrorCode::Unsupported);
  const std::string deep(100000, '[');
  const auto nested = read_mesh_bytes(std::as_bytes(std::span(deep)), "gltf");
  REQUIRE_FALSE(nested);
  CHECK(nested.error().code == ErrorCode::LimitExceeded);
}

TEST_CASE("gltf: unknown required extensions are named, those about looks are not needed") {
  Square square;
  square.more = R"(,"extensionsRequired":["KHR_texture_transform","EXT_strange","KHR_draco_mesh_compression"])";
  check_fails(square, "not supported: EXT_strange", ErrorCode::Unsupported);
  square.more = R"(,"extensionsRequired":["KHR_texture_transform"])";
  CHECK(read(square).mesh.face_count() == 2);
}

TEST_CASE("gltf: transforms apply in order, mirrors turn the winding, the identity keeps every bit") {
  Square square;
  square.nodes = R"([{"mesh":0,"rotation":[0,0,0,1],"scale":[1,1,1],"translation":[0,0,0]}])";
  const float odd = 0.1F;
  std::memcpy(square.binary.data() + 12, &odd, sizeof odd);
  CHECK(read(square).mesh.positions[1].x == odd);

  square = {};
  square.nodes = R"([{"translation":[10,0,0],"children":[1]},{"scale":[2,1,1],"mesh":0}])";
  CHECK(bounding_box(read(square).mesh).high.x == 12);
  CHECK(surface_area(read(square).mesh) == Approx(2));

  square.nodes = R"([{"scale":[-1,1,1],"mesh":0}])";
  const Mesh mirrored = read(square).mesh;
  const Vec3 a = mirrored.corner_position(0), b = mirrored.corner_position(1), c = mirrored.corner_position(2);
  CHECK(cross(b - a, c - a).z > 0);
}

TEST_CASE("gltf: faces stay as they wind, since materials may show one side alone") {
  Square square;
  const std::uint16_t turned[] = {2, 0};  // of the indices 0 1 2 0 2 3 the first and third
  std::memcpy(square.binary.data() + 48, &turned[0], 2);
  std::memcpy(square.binary.data() + 52, &turned[1], 2);
  CHECK(read(square).assembly.turned_faces == 0);
  CHECK(read(square).assembly.nonmanifold_edges == 1);
}

TEST_CASE("gltf: strips and fans become triangles of one winding, points and lines a note") {
  Square square;
  square.primitive = R"("attributes":{"POSITION":0},"mode":6)";
  CHECK(read(square).mesh.face_count() == 2);
  CHECK(read(square).assembly.nonmanifold_edges == 0);
  square.primitive = R"("attributes":{"POSITION":0},"mode":5)";
  CHECK(read(square).assembly.nonmanifold_edges == 0);
  CHECK(read(square).mesh.face_count() == 2);
  square.primitive = R"("attributes":{"POSITION":0},"mode":1)";
  CHECK(read(square).mesh.face_count() == 0);
  REQUIRE(read(square).notes.size() == 1);
  CHECK_THAT(read(square).notes[0], contains("points or lines"));
}

TEST_CASE("gltf: quantised positions are decoded") {
  Square square;
  square.binary.clear();
  for (const int v : {0, 0, 0, 0, 32767, 0, 0, 0, 32767, -32768, 0, 0, 0, -32767, 0, 0})
    put(square.binary, static_cast<std::int16_t>(v));
  square.binary.resize(48);
  for (const int i : {0, 1, 2, 0, 2, 3}) put(square.binary, static_cast<std::uint16_t>(i));
  square.positions = R"("bufferView":0,"componentType":5122,"normalized":true,"count":4,"type":"VEC3")";
  square.views = R"({"buffer":0,"byteLength":48,"byteStride":8},{"buffer":0,"byteOffset":48,"byteLength":12})";
  square.more = R"(,"extensionsRequired":["KHR_mesh_quantization"])";
  const Box box = bounding_box(read(square).mesh);
  CHECK(box.high.x == 1);
  CHECK(box.low.y == -1);
}

TEST_CASE("gltf: sparse accessors replace elements") {
  Square square;
  put(square.binary, std::uint16_t{2});
  put(square.binary, std::uint16_t{0});
  for (const float f : {5.F, 5.F, 0.F}) put(square.binary, f);
  square.buffers = R"([{"byteLength":76}])";
  square.views += R"(,{"buffer":0,"byteOffset":60,"byteLength":2},{"buffer":0,"byteOffset":64,"byteLength":12})";
  const std::string plain = square.positions;
  const auto sparse = [&](const std::string& count) {
    return plain + R"(,"sparse":{"count":)" + count +
           R"(,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}})";
  };
  square.positions = sparse("1");
  CHECK(bounding_box(read(square).mesh).high.x == 5);
  square.positions = sparse("2");
  check_fails(square, "accessor 0 sparse indices: count 2 from byte 0 exceeds buffer view of 2 bytes");
  square.positions = sparse("1");
  square.binary[60] = 4;
  check_fails(square, "accessor 0 sparse: index 4 is out of range: count is 4");
}

TEST_CASE("gltf: of a multi-LOD file the finest level is read") {
  Square square;
  square.nodes = R"([{"mesh":0,"extensions":{"MSFT_lod":{"ids":[1]}}},{"mesh":0,"translation":[5,0,0]}])";
  CHECK(read(square).mesh.face_count() == 2);
  CHECK(bounding_box(read(square).mesh).high.x == 1);
  square.nodes = R"([{"mesh":0,"extensions":{"MSFT_lod":{"ids":[8]}}}])";
  check_fails(square, "node 0: node 8 does not exist");
}

TEST_CASE("gltf: buffers may lie beside or below the document, nowhere else") {
  const ScratchDirectory scratch;
  const std::string binary = square_binary();
  std::filesystem::create_directory(scratch / "folder");
  std::ofstream(scratch / "folder/a b.bin", std::ios::binary) << binary;
  std::ofstream(scratch / "outside.bin", std::ios::binary) << binary;
  const auto read_with = [&](const std::string& uri) {
    std::ofstream(scratch / "folder/x.gltf") << R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
                   {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
      "buffers":[{"byteLength":60,"uri":")" << uri
                                             << "\"}]}";
    return read_mesh(scratch / "folder/x.gltf");
  };
  CHECK(read_with("a%20b.bin"));
  CHECK(read_with("./a b.bin"));
  for (const char* uri :
       {"../outside.bin", "%2e%2e/outside.bin", "/etc/passwd", "file:///etc/passwd", "..%5Coutside.bin"}) {
    const auto file = read_with(uri);
    REQUIRE_FALSE(file);
    CHECK(file.error().code == ErrorCode::Unsupported);
    CHECK_THAT(file.error().message, contains("buffer 0: ") && contains("beside or below"));
  }
  const auto missing = read_with("none.bin");
  REQUIRE_FALSE(missing);
  CHECK_THAT(missing.error().message, contains("buffer 0") && contains("none.bin"));
  CHECK_FALSE(read_with("data:application/octet-stream;base64,!!!!"));
}

TEST_CASE("gltf: what the mesh does not hold is noted") {
  const auto path = model("skin-morph/RobotExpressive.glb");
  if (!path) return;
  const auto file = read_mesh(*path);
  REQUIRE(file);
  std::string all;
  for (const std::string& note : file->notes) all += note + '\n';
  CHECK_THAT(all, contains("9 morph targets are left out; meshes are as their weights at rest") &&
                      contains("4 skins") && contains("14 animations") && contains("3 materials"));
}

namespace {

struct BothReadings {
  MeshFile joined;
  Scene scene;
};

/// Reads a file joined, and as a scene: both have the same faces in the same box.
BothReadings read_both(GltfMaker& maker) {
  auto joined = read_mesh_bytes(maker.glb(), "glb");
  auto scene = Scene::read_bytes(maker.glb(), "glb");
  REQUIRE(joined);
  REQUIRE(scene);
  std::size_t drawn = 0;
  for (const SceneMesh& mesh : scene->meshes()) drawn += mesh.mesh.face_count() * mesh.instance_count;
  CHECK(joined->mesh.face_count() == drawn);
  CHECK(length(bounding_box(joined->mesh).low - scene->box().low) < 1e-5);
  CHECK(length(bounding_box(joined->mesh).high - scene->box().high) < 1e-5);
  CHECK(validate(joined->mesh));
  return {std::move(*joined), std::move(*scene)};
}

std::vector<float> times(const TriangleSoup& soup, float factor) {
  std::vector<float> values;
  for (const Vec3f& p : soup.positions) values.insert(values.end(), {factor * p.x, factor * p.y, factor * p.z});
  return values;
}

}  // namespace

TEST_CASE("gltf: instances are drawn once for each, mirrored ones, too") {
  GltfMaker maker;
  const TriangleSoup ball = icosphere(1, 0, 1);
  add_node(maker, "many", add_mesh(maker, "ball", ball), {{"translation", {0, 0, 3}}});
  GltfJson& attributes = maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = maker.add_floats({0, 0, 0, 5, 0, 0, 0, 9, 0}, "VEC3", 3);
  attributes["SCALE"] = maker.add_floats({1, 1, 1, -1, 1, 1, 2, 2, 2}, "VEC3", 3);
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Mesh mesh = read_both(maker).joined.mesh;
  CHECK(mesh.face_count() == 3 * ball.indices.size() / 3);
  // Outward faces enclose a positive volume.
  double volume = 0;
  for (std::size_t i = 0; i < mesh.corner_wedge.size(); i += 3) {
    const auto at = [&](std::size_t k) { return Vec3(mesh.positions[mesh.wedge_vertex[mesh.corner_wedge[i + k]]]); };
    volume += dot(at(0), cross(at(1), at(2))) / 6;
  }
  CHECK(volume > 10 * 3.5);
}

TEST_CASE("gltf: meshes are as the weights of their morph targets at rest have them, a node's own before its mesh's") {
  GltfMaker maker;
  const TriangleSoup ball = icosphere(1, 0, 1);
  const std::size_t mesh = add_mesh(maker, "ball", ball);
  GltfJson& primitive = maker.json["meshes"][mesh]["primitives"][0];
  primitive["attributes"]["NORMAL"] = maker.add_floats(times(ball, 1), "VEC3", 3);
  primitive["targets"] = {{{"POSITION", maker.add_floats(times(ball, 1), "VEC3", 3)}},
                          {{"POSITION", maker.add_floats(times(ball, -2), "VEC3", 3)},
                           {"NORMAL", maker.add_floats(times(ball, -2), "VEC3", 3)}}};
  add_node(maker, "plain", mesh);
  CHECK(bounding_box(read_both(maker).joined.mesh).diagonal() == Approx(2 * std::sqrt(3)).epsilon(0.1));
  const double diagonal = bounding_box(read_both(maker).joined.mesh).diagonal();
  const auto check_size = [&](double factor, float normal) {
    const Mesh shown = read_both(maker).joined.mesh;
    CHECK(bounding_box(shown).diagonal() == Approx(factor * diagonal));
    REQUIRE(shown.attributes.size() == 1);
    Vec3f direction;
    std::memcpy(&direction, shown.attributes[0].data.data(), sizeof direction);
    CHECK(dot(normalized(Vec3(shown.positions[0])), Vec3(direction)) == Approx(factor > 0 ? normal : -normal));
  };
  maker.json["meshes"][mesh]["weights"] = {2, 0};
  check_size(3, 1);
  maker.json["meshes"][mesh]["weights"] = {0, 2};
  check_size(3, 1);  // turned inside out, and its normals with it
  maker.json["nodes"][0]["weights"] = {0.5, 0};
  check_size(1.5, 1);
  maker.json["nodes"][0]["weights"] = {0};
  check_size(1, 1);
  add_node(maker, "again", mesh, {{"translation", {40, 0, 0}}, {"weights", {5, 0}}});
  add_node(maker, "third", mesh, {{"translation", {0, 40, 0}}});
  CHECK(bounding_box(read_both(maker).joined.mesh).high.x == Approx(46).epsilon(0.01));
}

TEST_CASE(
    "gltf: what the same instance draws twice is one face, what nodes, primitives, skins or targets tell apart is "
    "not") {
  const TriangleSoup ball = icosphere(1, 0, 1);
  const std::size_t faces = ball.indices.size() / 3, points = ball.positions.size();
  TriangleSoup twice = ball;
  twice.indices.insert(twice.indices.end(), ball.indices.begin(), ball.indices.end());
  GltfMaker maker;
  add_node(maker, "twice", add_mesh(maker, "twice", twice));
  CHECK(read_both(maker).joined.mesh.face_count() == faces);
  add_node(maker, "again", 0);
  CHECK(read_both(maker).joined.mesh.face_count() == 2 * faces);
  GltfJson& primitives = maker.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  CHECK(read_both(maker).joined.mesh.face_count() == 4 * faces);

  // The second half of the points has other targets, or other joints.
  twice = ball;
  for (const Vec3f& p : ball.positions) twice.positions.push_back(p);
  for (const Index point : ball.indices) twice.indices.push_back(static_cast<Index>(points + point));
  for (const bool skinned : {false, true}) {
    GltfMaker other;
    add_node(other, "twice", add_mesh(other, "twice", twice));
    CHECK(read_both(other).joined.mesh.face_count() == faces);
    GltfJson& primitive = other.json["meshes"][0]["primitives"][0];
    if (skinned) {
      std::vector<std::uint8_t> joints(4 * 2 * points);
      std::vector<float> weights(4 * 2 * points);
      for (std::size_t i = 0; i < 2 * points; ++i) joints[4 * i] = i >= points, weights[4 * i] = 1;
      primitive["attributes"]["JOINTS_0"] = other.add_accessor(joints, 5121, "VEC4", 4);
      primitive["attributes"]["WEIGHTS_0"] = other.add_floats(weights, "VEC4", 4);
      for (const char* name : {"a", "b"})
        other.json["scenes"][0]["nodes"].push_back(other.add("nodes", {{"name", name}}));
      other.add("skins", {{"joints", {1, 2}}});
      other.json["nodes"][0]["skin"] = 0;
    } else {
      std::vector<float> moves(3 * points), up(3 * points, 1.0F);
      moves.insert(moves.end(), up.begin(), up.end());
      primitive["targets"] = {{{"POSITION", other.add_floats(moves, "VEC3", 3)}}};
    }
    CHECK(read_both(other).joined.mesh.face_count() == 2 * faces);
  }
}

TEST_CASE("gltf: a file that names one accessor again and again is refused before memory ends") {
  GltfMaker maker;
  add_node(maker, "ball", add_mesh(maker, "ball", icosphere(4, 0, 1)));
  GltfJson& primitive = maker.json["meshes"][0]["primitives"][0];
  const GltfJson target = {{"POSITION", primitive["attributes"]["POSITION"]}};
  primitive["targets"] = GltfJson(100'000, target);
  for (const auto& code :
       {read_mesh_bytes(maker.glb(), "glb").error().code, Scene::read_bytes(maker.glb(), "glb").error().code})
    CHECK(code == ErrorCode::LimitExceeded);
}

TEST_CASE("gltf: files from the field have as many faces joined as their scenes draw") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  for (const char* name : {"skin-morph/Knight.glb", "skin-morph/RobotExpressive.glb", "skin-morph/MorphStressTest.gltf",
                           "field/coincident-morphed.glb", "field/coincident-skinned.glb", "field/doubled-faces.glb",
                           "field/overlay-materials.glb", "field/grows-by-animation.glb"}) {
    INFO(name);
    std::size_t drawn = 0;
    const Scene scene = Scene::read(*model(name)).value();
    for (const SceneMesh& mesh : scene.meshes()) drawn += mesh.mesh.face_count() * mesh.instance_count;
    CHECK(read_mesh(*model(name)).value().mesh.face_count() == drawn);
  }
}

}  // namespace lodestone::test

#include <lodestone/io/scene.h>

#include <string>
#include <vector>

#include "support/data.h"
#include "support/gltf_file.h"
#include "support/gltf_shapes.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

/// Values of a node's property at times 0, 1, 2, …; with CUBICSPLINE between tangents.
struct Channel {
  std::size_t node;
  std::string path;
  std::vector<float> values;
  std::string interpolation = "LINEAR";
};

GltfJson target_of(const Channel& channel, bool by_pointer) {
  if (!by_pointer) return {{"node", channel.node}, {"path", channel.path}};
  const std::string pointer = "/nodes/" + std::to_string(channel.node) + "/" + channel.path;
  return {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
}

void animate(GltfMaker& maker, const std::vector<Channel>& channels, bool by_pointer = false) {
  GltfJson animation = {{"samplers", GltfJson::array()}, {"channels", GltfJson::array()}};
  for (const Channel& channel : channels) {
    const std::size_t width = channel.path == "rotation" ? 4 : 3;
    const std::size_t key_count = channel.values.size() / width / (channel.interpolation == "CUBICSPLINE" ? 3 : 1);
    std::vector<float> times;
    for (std::size_t i = 0; i < key_count; ++i) times.push_back(static_cast<float>(i));
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", target_of(channel, by_pointer)}});
    animation["samplers"].push_back({{"input", maker.add_floats(times, "SCALAR", 1)},
                                     {"output", maker.add_floats(channel.values, width == 4 ? "VEC4" : "VEC3", width)},
                                     {"interpolation", channel.interpolation}});
  }
  maker.add("animations", std::move(animation));
}

Scene read(GltfMaker& maker) {
  auto scene = Scene::read_bytes(maker.glb(), "glb");
  INFO((scene ? std::string() : scene.error().message));
  REQUIRE(scene);
  return std::move(*scene);
}

/// Two balls of radius 1: the first at the origin, to be animated, the second beside it.
GltfMaker two_balls(GltfJson first = {}) {
  GltfMaker maker;
  add_mesh(maker, "ball", icosphere(1, 0, 1));
  add_mesh(maker, "still", icosphere(1, 0, 1));
  add_node(maker, "ball", 0, std::move(first));
  add_node(maker, "still", 1, {{"translation", {9, 0, 0}}});
  return maker;
}

}  // namespace

TEST_CASE("a mesh counts as large as any key frame of its node makes it") {
  const std::vector<Channel> families = {
      {0, "scale", {0, 0, 0, 3, 1, 1, 0.1F, 0.1F, 0.1F}, "STEP"},
      {0, "scale", {0, 0, 0, 1, -3, 1, 0.1F, 0.1F, 0.1F}, "LINEAR"},
      {0, "scale", {8, 8, 8, 0, 0, 0, 9, 9, 9, 8, 8, 8, 1, 3, 1, 9, 9, 9}, "CUBICSPLINE"},
  };
  for (const Channel& channel : families)
    for (const bool by_pointer : {false, true}) {
      INFO(channel.interpolation << (by_pointer ? " by pointer" : ""));
      GltfMaker maker = two_balls({{"scale", {0.001, 0.001, 0.001}}});
      const double still_area = read(maker).meshes()[1].area;
      animate(maker, {channel}, by_pointer);
      const Scene scene = read(maker);
      CHECK(scene.meshes()[0].scale == Approx(3));
      CHECK(scene.meshes()[0].area > 1.5 * still_area);
      CHECK(scene.meshes()[1].scale == Approx(1));
      CHECK(scene.meshes()[1].area == still_area);
      const bool along_x = channel.interpolation == "STEP";
      CHECK((along_x ? scene.box().low.x : scene.box().low.y) == Approx(-3).epsilon(0.2));
    }
}

TEST_CASE("ancestors and instances grow their meshes, at one key frame of very many, too") {
  GltfMaker maker = two_balls({{"scale", {2, 2, 2}}});
  const std::size_t scales = maker.add_floats({1, 1, 1, 5, 5, 5}, "VEC3", 3);
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = scales;
  maker.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const std::size_t parent = maker.add("nodes", {{"children", {0}}});
  const std::size_t root = maker.add("nodes", {{"children", {parent}}});
  maker.json["scenes"][0]["nodes"] = {1, root};
  std::vector<float> values(3 * 5000, 1.0F);
  values[3 * 1717 + 1] = -7;
  animate(maker, {{1, "translation", {0, 0, 0, 500, 0, 0}}});
  animate(maker, {{root, "scale", values}, {parent, "translation", {0, 0, 0, 1, 1, 1}}});
  const Scene scene = read(maker);
  CHECK(scene.meshes()[0].scale == Approx(70));
  CHECK(scene.meshes()[0].instance_count == 2);
  CHECK(scene.meshes()[1].scale == Approx(1));
}

TEST_CASE("what animations only move, turn or make smaller stays as it is at rest") {
  GltfMaker maker = two_balls({{"scale", {2, 1, 1}}});
  const Scene still = read(maker);
  animate(maker, {{0, "scale", {2, 1, 1, 0, 0, 0, 1, 1, 1}},
                  {0, "translation", {0, 0, 0, 99, 0, 0}},
                  {0, "rotation", {0, 0, 0, 1, 0, 0.6F, 0, 0.8F}}});
  const Scene moved = read(maker);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(moved.meshes()[i].scale == still.meshes()[i].scale);
    CHECK(moved.meshes()[i].area == still.meshes()[i].area);
  }
  CHECK(moved.box().low == still.box().low);
  CHECK(moved.box().high == still.box().high);
}

TEST_CASE("a skinned mesh counts as large as any key frame of its joints makes it") {
  GltfMaker maker = two_balls();
  const std::size_t count = icosphere(1, 0, 1).positions.size();
  std::vector<float> weights(4 * count);
  for (std::size_t i = 0; i < count; ++i) weights[4 * i] = 1;
  GltfJson& attributes = maker.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = maker.add_accessor(std::vector<std::uint8_t>(4 * count), 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] = maker.add_floats(weights, "VEC4", 4);
  const std::size_t joint = maker.add("nodes", {{"name", "joint"}});
  maker.json["scenes"][0]["nodes"].push_back(joint);
  maker.add("skins", {{"joints", {joint}}});
  maker.json["nodes"][0]["skin"] = 0;
  CHECK(read(maker).meshes()[0].scale == Approx(1));
  animate(maker, {{0, "scale", {1, 1, 1, 50, 50, 50}}});  // without effect on what is skinned
  CHECK(read(maker).meshes()[0].scale == Approx(1));
  animate(maker, {{joint, "scale", {1, 1, 1, 4, 4, 4, 1, 1, 1}}, {joint, "translation", {0, 0, 0, 0, 0, 7, 0, 0, 0}}});
  const Scene scene = read(maker);
  CHECK(scene.meshes()[0].skinned);
  CHECK(scene.meshes()[0].scale == Approx(4));
  CHECK(scene.box().high.z == Approx(11).epsilon(0.05));
}

namespace {

/// Two balls as above; the first has two morph targets that move every point by 2 and by 3 times its place.
GltfMaker two_morphed_balls(GltfJson first = {}) {
  GltfMaker maker = two_balls(std::move(first));
  GltfJson& primitive = maker.json["meshes"][0]["primitives"][0];
  for (const float factor : {2.0F, 3.0F}) {
    std::vector<float> moves;
    for (const Vec3f& p : icosphere(1, 0, 1).positions)
      moves.insert(moves.end(), {factor * p.x, factor * p.y, factor * p.z});
    primitive["targets"].push_back({{"POSITION", maker.add_floats(moves, "VEC3", 3)}});
  }
  return maker;
}

/// Animates weights from time 0 to 1; the path is that of a node's own channel, or a pointer.
void animate_weights(GltfMaker& maker, const std::string& path, const std::vector<float>& values,
                     const char* interpolation = "LINEAR") {
  GltfJson target = {{"node", 0}, {"path", "weights"}};
  if (path != "weights")
    target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", path}}}}}};
  const GltfJson sampler = {{"input", maker.add_floats({0, 1}, "SCALAR", 1)},
                            {"output", maker.add_floats(values, "SCALAR", 1)},
                            {"interpolation", interpolation}};
  maker.add("animations", {{"samplers", GltfJson::array({sampler})},
                           {"channels", GltfJson::array({{{"sampler", 0}, {"target", target}}})}});
}

/// The largest weights of the first ball's targets, as far as it is.
std::vector<double> reached(GltfMaker& maker) {
  const Scene scene = read(maker);
  std::vector<double> reach = scene.meshes()[0].target_reach;
  for (double& weight : reach) weight *= scene.meshes()[0].scale;
  CHECK(scene.meshes()[1].target_reach.empty());
  CHECK(scene.meshes()[1].scale == Approx(1));
  return reach;
}

std::vector<double> reached(const std::string& path, const std::vector<float>& values, const char* interpolation) {
  GltfMaker maker = two_morphed_balls();
  maker.json["meshes"][0]["weights"] = {0.5, 0};
  animate_weights(maker, path, values, interpolation);
  return reached(maker);
}

void check_close(const std::vector<double>& found, const std::vector<double>& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == Approx(expected[i]).epsilon(1e-5));
}

}  // namespace

TEST_CASE("each morph target counts at the largest weight that it reaches, of either sign, and never below 1") {
  check_close(reached("weights", {0, 0, 0.5F, 0.25F}, "LINEAR"), {1, 1});
  check_close(reached("weights", {0, 0, 0.5F, -4}, "LINEAR"), {1, 4});
  check_close(reached("weights", {9, 9, 0, 3, 0, 0, 0, 0, 1, 3, 9, 9}, "CUBICSPLINE"), {1, 3});
  check_close(reached("/nodes/0/weights", {0, 5, 2, 0}, "STEP"), {2, 5});
  check_close(reached("/meshes/0/weights", {0, 6, 0, 0}, "STEP"), {1, 6});
  check_close(reached("/nodes/0/weights/1", {0, -7}, "LINEAR"), {1, 7});
  check_close(reached("/meshes/0/weights/0", {8, 1}, "LINEAR"), {8, 1});
}

TEST_CASE("a spline counts where it goes between its key frames") {
  // From 0 to 0, leaving at a slope of 27: 27 t (1 − t)² is largest at a third, 4.
  check_close(reached("/nodes/0/weights/0", {0, 0, 27, 0, 0, 0}, "CUBICSPLINE"), {4, 1});
  check_close(reached("/nodes/0/weights/0", {0, 0, 27, 0, 0, 0}, "LINEAR"), {1, 1});
}

TEST_CASE("weights of animations that are broken, or of others, count for nothing") {
  for (const char* path : {"/meshes/1/weights", "/meshes/77/weights", "/nodes/1/weights", "/nodes/77/weights/0",
                           "/nodes/0/weights/2", "/nodes/0/weights/x", "/nodes/0/weights/0/1", "/nodes/0/weight",
                           "/meshes/0/scale", "/meshes/99999999999999999999/weights"})
    check_close(reached(path, {0, 6}, "STEP"), {1, 1});
  check_close(reached("weights", {6, 6, 6, 6, 6, 6}, "STEP"), {1, 1});
  check_close(reached("weights", {}, "STEP"), {1, 1});
  GltfMaker maker = two_morphed_balls();
  maker.json["meshes"][0]["weights"] = {"x", nullptr};
  maker.json["nodes"][0]["weights"] = 8;
  check_close(reached(maker), {1, 1});
}

TEST_CASE("a node's own weights stand for those of its mesh, and of several nodes the largest count") {
  GltfMaker maker = two_morphed_balls();
  maker.json["meshes"][0]["weights"] = {4, 0};
  check_close(reached(maker), {4, 1});
  maker.json["nodes"][0]["weights"] = {0, 2};
  animate_weights(maker, "/meshes/0/weights", {9, 9, 9, 9});
  check_close(reached(maker), {1, 2});
  add_node(maker, "again", 0, {{"weights", {0, 7}}, {"scale", {2, 2, 2}}});
  check_close(reached(maker), {2, 14});
  add_node(maker, "third", 0);
  check_close(reached(maker), {9, 14});
}

TEST_CASE("a mesh counts as large as its morph targets make it, at rest and at any key frame") {
  for (const bool at_rest : {true, false}) {
    GltfMaker maker = two_morphed_balls({{"scale", {0.1, 0.1, 0.1}}});
    if (at_rest)
      maker.json["meshes"][0]["weights"] = {0, 3};
    else
      animate_weights(maker, "weights", {0, 0, 0, 3});
    const Scene scene = read(maker);
    CHECK(scene.meshes()[0].scale == Approx(1));
    CHECK(scene.meshes()[0].area == Approx(scene.meshes()[1].area));
    CHECK(scene.box().low.x == Approx(-1).epsilon(0.1));
    check_close(scene.meshes()[0].target_reach, {0.1, 0.3});
  }
  GltfMaker smaller = two_morphed_balls();
  animate_weights(smaller, "weights", {0, 0, -0.4F, 0});
  CHECK(read(smaller).meshes()[0].scale == Approx(1));
  CHECK(read(smaller).meshes()[0].area == Approx(read(smaller).meshes()[1].area));
}

TEST_CASE("animations that are broken or not of nodes leave sizes as they are at rest") {
  GltfMaker maker = two_balls({{"scale", {2, 2, 2}}});
  const std::size_t times = maker.add_floats({0, 1}, "SCALAR", 1);
  const std::size_t backwards = maker.add_floats({1, 0}, "SCALAR", 1);
  const std::size_t one = maker.add_floats({9, 9, 9}, "VEC3", 3);
  const std::size_t two = maker.add_floats({9, 9, 9, 9, 9, 9}, "VEC3", 3);
  const auto pointer = [](const char* path) {
    return GltfJson{{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", path}}}}}};
  };
  const GltfJson scale = {{"node", 0}, {"path", "scale"}};
  const auto add = [&](GltfJson sampler, GltfJson target) {
    maker.add("animations", {{"samplers", GltfJson::array({std::move(sampler)})},
                             {"channels", {{{"sampler", 0}, {"target", std::move(target)}}, {{"sampler", 8}}}}});
  };
  for (const GltfJson& sampler :
       {GltfJson{{"input", times}, {"output", one}}, GltfJson{{"input", 999}, {"output", two}},
        GltfJson{{"input", backwards}, {"output", two}}, GltfJson{{"output", two}}})
    add(sampler, scale);
  const GltfJson good = {{"input", times}, {"output", two}};
  for (const GltfJson& target :
       {GltfJson{{"node", 77}, {"path", "scale"}}, GltfJson{{"path", "scale"}}, GltfJson{{"node", 0}, {"path", "size"}},
        pointer("/nodes/0"), pointer("/nodes/x/scale"), pointer("/nodes/77/scale"), pointer("/materials/0/scale")})
    add(good, target);
  maker.add("animations", GltfJson::object());
  CHECK(read(maker).meshes()[0].scale == Approx(2));
  add(good, scale);
  CHECK(read(maker).meshes()[0].scale == Approx(9));
}

TEST_CASE("the field's animation makes its mesh as large as the still one beside it") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const Scene scene = Scene::read(*model("field/grows-by-animation.glb")).value();
  REQUIRE(scene.meshes().size() == 2);
  CHECK(scene.meshes()[0].scale == scene.meshes()[1].scale);
  CHECK(scene.meshes()[0].area == Approx(scene.meshes()[1].area));
}

}  // namespace lodestone::test

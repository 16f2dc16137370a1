// What is off in a file's normals, tangents and skins is off in its finest level, and in no other.

#include <lodestone/io/scene.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "support/gltf_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

constexpr int kSide = 12;  // squares of the grid that carries the attributes
constexpr std::size_t kPointCount = (kSide + 1) * (kSide + 1);

/// A grid in the unit square, a point for each of its places.
TriangleSoup indexed_grid() {
  TriangleSoup soup;
  for (int y = 0; y <= kSide; ++y)
    for (int x = 0; x <= kSide; ++x)
      soup.positions.push_back({static_cast<float>(x) / kSide, static_cast<float>(y) / kSide, 0});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (const int corner : {0, 1, kSide + 1, 1, kSide + 2, kSide + 1})
        soup.indices.push_back(static_cast<Index>(y * (kSide + 1) + x + corner));
  return soup;
}

struct Maker : GltfMaker {
  Maker() { add_node(*this, "grid", add_mesh(*this, "grid", indexed_grid())); }

  template <class T>
  void add_attribute(const char* name, const std::vector<T>& values, int component_type, std::size_t components,
                     bool normalized) {
    const std::size_t number = add_accessor(values, component_type, components == 3 ? "VEC3" : "VEC4", components);
    if (normalized) json["accessors"][number]["normalized"] = true;
    json["meshes"][0]["primitives"][0]["attributes"][name] = number;
  }
};

using Bytes = std::string;

/// Cuts bytes into `count` elements.
std::vector<Bytes> elements_of(const ByteVector& bytes, std::size_t count) {
  std::vector<Bytes> elements;
  const auto* first = reinterpret_cast<const char*>(bytes.data());
  const std::size_t width = bytes.size() / count;
  for (std::size_t i = 0; i < count; ++i) elements.emplace_back(first + i * width, width);
  return elements;
}

/// The positions of the input's points.
std::vector<Bytes> positions_of(const GltfFile& in) { return elements_of(in.accessor_bytes(0), kPointCount); }

/// The elements of an attribute in a node's mesh, by the bytes of their positions.
std::map<Bytes, Bytes> by_position(const GltfFile& file, const std::string& node_name, const std::string& attribute) {
  std::map<Bytes, Bytes> elements;
  for (const GltfJson& node : file.json["nodes"]) {
    if (node.value("name", "") != node_name) continue;
    const GltfJson& attributes = file.json["meshes"][node.at("mesh").get<std::size_t>()]["primitives"][0]["attributes"];
    const ByteVector positions = file.accessor_bytes(attributes.at("POSITION"));
    const std::size_t count = positions.size() / sizeof(Vec3f);
    const std::vector<Bytes> keys = elements_of(positions, count),
                             values = elements_of(file.accessor_bytes(attributes.at(attribute)), count);
    for (std::size_t i = 0; i < count; ++i) elements[keys[i]] = values[i];
  }
  return elements;
}

/// Builds without a simplifier: the grid, again the grid, and two levels of half its faces.
GltfFile encoded(GltfMaker& maker, Compression compression = Compression::None) {
  const auto scene = Scene::read_bytes(maker.glb(), "glb");
  REQUIRE(scene);
  LeveledMesh leveled;
  for (int level = 0; level < 4; ++level) leveled.levels.push_back({scene->meshes()[0].mesh, {}, 0, "faces"});
  for (const int level : {2, 3}) {
    std::vector<Index>& corners = leveled.levels[level].mesh.corner_wedge;
    corners.resize(corners.size() / 6 * 3);
  }
  AssetOptions options;
  options.compression = compression;
  const auto asset = encode_scene(*scene, std::span(&leveled, 1), options);
  REQUIRE(asset);
  return GltfFile::from_glb(asset->glb);
}

template <class T>
T component(const Bytes& element, std::size_t at) {
  T value;
  std::memcpy(&value, element.data() + at * sizeof value, sizeof value);
  return value;
}

template <class T>
double unit() {
  return std::is_same_v<T, float> ? 1 : static_cast<double>(std::numeric_limits<T>::max());
}

template <class T>
std::vector<double> values_of(const Bytes& element) {
  std::vector<double> values;
  for (std::size_t i = 0; i < element.size() / sizeof(T); ++i)
    values.push_back(static_cast<double>(component<T>(element, i)) / unit<T>());
  return values;
}

template <class T>
T stored(double value) {
  return static_cast<T>(std::is_same_v<T, float> ? value : std::round(value * unit<T>()));
}

constexpr int code(float) { return 5126; }
constexpr int code(std::uint8_t) { return 5121; }
constexpr int code(std::uint16_t) { return 5123; }
constexpr int code(std::int8_t) { return 5120; }
constexpr int code(std::int16_t) { return 5122; }

/// A point's joints and weights of all sets, and whether they are as glTF wants them.
struct Skinning {
  std::vector<std::uint8_t> joints;
  std::vector<double> weights;
  bool is_right = true;

  /// How much of the point each joint moves; of a point without weights, all by the first.
  std::map<int, double> shares() const {
    std::map<int, double> shares;
    double sum = 0;
    for (const double weight : weights) sum += std::max(weight, 0.0);
    if (sum == 0) return {{joints[0], 1}};
    for (std::size_t i = 0; i < joints.size(); ++i)
      if (weights[i] > 0) shares[joints[i]] += weights[i] / sum;
    return shares;
  }
};

/// Every way in which files are off, in turn.
Skinning make_skinning(std::size_t point, std::size_t set_count, bool may_be_negative, Random& random) {
  Skinning skinning;
  for (std::size_t i = 0; i < 4 * set_count; ++i) {
    const bool used = i == 0 || i == 2;
    skinning.joints.push_back(static_cast<std::uint8_t>(used ? i + 1 + random.below(2) : 0));
    skinning.weights.push_back(i == 0 ? 0.75 : i == 2 ? 0.25 : 0);
  }
  const std::size_t way = point % 7;
  skinning.is_right = way == 0;
  if (way == 1) skinning.weights[0] = 0.5 * random.unit() + 0.1;
  if (way == 2) skinning.weights.assign(skinning.weights.size(), 0);
  if (way == 3) skinning.joints[2] = skinning.joints[0];
  if (way == 4) skinning.joints.back() = 9;
  if (way == 5) skinning.weights.assign(skinning.weights.size(), 1);
  if (way == 6) skinning.weights[1] = may_be_negative ? -0.25 : 0.125;
  return skinning;
}

/// Each of the grid's points by turns; integers take the weights they can hold.
template <class T>
std::vector<Skinning> add_skin(Maker& maker, std::size_t set_count) {
  Random random(set_count);
  std::vector<Skinning> points;
  std::vector<std::vector<std::uint8_t>> joints(set_count);
  std::vector<std::vector<T>> weights(set_count);
  for (std::size_t i = 0; i < kPointCount; ++i) {
    Skinning skinning = make_skinning(i, set_count, std::is_same_v<T, float>, random);
    if (skinning.is_right) skinning.weights[2] = 1 - static_cast<double>(stored<T>(0.75)) / unit<T>();
    for (std::size_t k = 0; k < skinning.joints.size(); ++k) {
      const T weight = stored<T>(skinning.weights[k]);
      skinning.weights[k] = static_cast<double>(weight) / unit<T>();
      joints[k / 4].push_back(skinning.joints[k]);
      weights[k / 4].push_back(weight);
    }
    points.push_back(std::move(skinning));
  }
  for (std::size_t set = 0; set < set_count; ++set) {
    maker.add_attribute(("JOINTS_" + std::to_string(set)).c_str(), joints[set], 5121, 4, false);
    maker.add_attribute(("WEIGHTS_" + std::to_string(set)).c_str(), weights[set], code(T{}), 4,
                        !std::is_same_v<T, float>);
  }
  return points;
}

/// What a file says of a node's skin, by position.
template <class T>
std::map<Bytes, Skinning> skin_of(const GltfFile& file, const std::string& node, std::size_t set_count) {
  std::map<Bytes, Skinning> points;
  for (std::size_t set = 0; set < set_count; ++set) {
    for (const auto& [position, joints] : by_position(file, node, "JOINTS_" + std::to_string(set)))
      for (std::size_t k = 0; k < 4; ++k) points[position].joints.push_back(component<std::uint8_t>(joints, k));
    for (const auto& [position, bytes] : by_position(file, node, "WEIGHTS_" + std::to_string(set))) {
      const std::vector<double> weights = values_of<T>(bytes);
      points[position].weights.insert(points[position].weights.end(), weights.begin(), weights.end());
    }
  }
  return points;
}

void check_right(const Skinning& skinning) {
  std::set<int> named;
  double sum = 0;
  for (std::size_t i = 0; i < skinning.joints.size(); ++i) {
    sum += skinning.weights[i];
    CHECK(skinning.weights[i] >= 0);
    if (skinning.weights[i] > 0) CHECK(named.insert(skinning.joints[i]).second);
    if (skinning.weights[i] == 0) CHECK(skinning.joints[i] == 0);
  }
  CHECK(std::abs(sum - 1) < 2e-7);
}

/// All attributes of the finest level are the input's, bit for bit.
void check_kept(const GltfFile& in, const GltfFile& out) {
  for (const auto& [name, accessor] : in.json["meshes"][0]["primitives"][0]["attributes"].items())
    CHECK(by_position(out, "grid_LOD0", name) == by_position(in, "grid", name));
}

template <class T>
void check_skin(std::size_t set_count, const std::string& node) {
  const double tolerance = std::is_same_v<T, float> ? 1e-6 : 8 / unit<T>();
  Maker maker;
  const std::vector<Skinning> points = add_skin<T>(maker, set_count);
  const GltfFile in = GltfFile::from_glb(maker.glb()), out = encoded(maker);
  check_kept(in, out);
  const std::map<Bytes, Skinning> mended = skin_of<T>(out, node, set_count);
  CHECK(mended.size() > kPointCount / 3);
  const std::vector<Bytes> positions = positions_of(in);
  for (std::size_t i = 0; i < kPointCount; ++i) {
    const auto found = mended.find(positions[i]);
    if (found == mended.end()) continue;
    INFO("point " << i);
    check_right(found->second);
    if (points[i].is_right) CHECK(found->second.weights == points[i].weights);
    if (points[i].is_right) CHECK(found->second.joints == points[i].joints);
    auto after = found->second.shares();
    for (const auto& [joint, share] : points[i].shares()) CHECK(std::abs(share - after[joint]) < tolerance);
  }
}

/// Directions of any length, some of none; `w` for tangents.
template <class T>
std::vector<T> make_directions(std::size_t width) {
  Random random(width);
  std::vector<T> values;
  for (std::size_t i = 0; i < kPointCount; ++i) {
    Vec3 v = normalized(Vec3(random.signed_unit(), random.signed_unit(), 0.1 + random.unit()));
    const std::size_t way = i % 5;
    if (way == 1) v = v * 0.6;
    if (way == 2) v = Vec3();
    if (way == 3 && std::is_same_v<T, float>) v.x = std::numeric_limits<double>::quiet_NaN();
    for (const double component : {v.x, v.y, v.z}) values.push_back(stored<T>(component));
    if (width == 4) values.push_back(stored<T>(way == 0 ? -1 : way == 4 ? 0 : 1));
  }
  return values;
}

Vec3 vector_of(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

template <class T>
void check_directions(const char* name, std::size_t width, const std::string& node) {
  Maker maker;
  maker.json["extensionsUsed"] = maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  maker.add_attribute("NORMAL", make_directions<T>(3), code(T{}), 3, !std::is_same_v<T, float>);
  maker.add_attribute("TANGENT", make_directions<T>(4), code(T{}), 4, !std::is_same_v<T, float>);
  const GltfFile in = GltfFile::from_glb(maker.glb()), out = encoded(maker);
  const auto before = by_position(in, "grid", name), after = by_position(out, node, name);
  check_kept(in, out);
  CHECK(after.size() > kPointCount / 3);
  const std::vector<Bytes> positions = positions_of(in);
  for (std::size_t i = 0; i < kPointCount; ++i) {
    const auto found = after.find(positions[i]);
    if (found == after.end()) continue;
    INFO("point " << i);
    const std::vector<double> old_values = values_of<T>(before.at(found->first)), values = values_of<T>(found->second);
    CHECK(std::abs(length(vector_of(values)) - 1) < 0.00674);  // as gltf-validator wants it
    if (width == 4) CHECK(std::abs(values[3]) == 1);
    if (i % 5 == 0) CHECK(found->second == before.at(found->first));
    if (i % 5 == 1) CHECK(angle_between(vector_of(values), vector_of(old_values)) < 0.02);
  }
}

}  // namespace

TEST_CASE("skin weights that are off are right in coarser levels, and move points as they did") {
  for (const char* node : {"grid_LOD1", "grid_LOD3"})
    for (const std::size_t set_count : {1, 2}) {
      check_skin<float>(set_count, node);
      check_skin<std::uint8_t>(set_count, node);
      check_skin<std::uint16_t>(set_count, node);
    }
}

TEST_CASE("normals and tangents that are off have length 1 in coarser levels, and the directions they had") {
  for (const char* node : {"grid_LOD1", "grid_LOD3"})
    for (const auto& [name, width] : {std::pair("NORMAL", 3), std::pair("TANGENT", 4)}) {
      check_directions<float>(name, width, node);
      check_directions<std::int8_t>(name, width, node);
      check_directions<std::int16_t>(name, width, node);
    }
}

}  // namespace lodestone::test

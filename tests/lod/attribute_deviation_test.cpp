#include <lodestone/lod/attribute_deviation.h>

#include <algorithm>
#include <cmath>

#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

double mean_of(const std::vector<AttributeDeviation>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name == name; });
  REQUIRE(found != all.end());
  CHECK(found->mean <= found->rms + 1e-12);
  CHECK(found->rms <= found->maximum + 1e-12);
  return found->mean;
}

Mesh level_of(const Mesh& mesh, std::size_t faces, const AttributeWeights& weights) {
  SimplifyOptions options;
  options.weights = weights;
  options.measure_step = 0;
  const auto result = simplify(mesh, options);
  REQUIRE(result);
  Cursor cursor(result->mesh);
  cursor.seek(position_for_faces(result->mesh, faces));
  return extract_level(result->mesh, cursor);
}

}  // namespace

TEST_CASE("a mesh's attributes do not deviate from themselves") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    for (const AttributeDeviation& a : measure_attributes(mesh, mesh, 2000)) {
      INFO(a.name);
      // At a corner of several normals the nearest point may be on another side; never in the middle of a face.
      CHECK(a.maximum < 1e-5);
    }
  }
}

TEST_CASE("a texture moved by a known length deviates by that length") {
  const Mesh mesh = mesh_of(mirrored_terrain(8));
  Mesh moved = mesh;
  for (std::size_t w = 0; w < mesh.wedge_count(); ++w) {
    float u = 0;
    std::memcpy(&u, &moved.attributes[0].data[8 * w], 4);
    u += 0.125F;
    std::memcpy(&moved.attributes[0].data[8 * w], &u, 4);
  }
  CHECK(mean_of(measure_attributes(mesh, moved), "TEXCOORD_0") == Approx(0.125).epsilon(1e-4));
}

TEST_CASE("weights keep what they weigh") {
  AttributeWeights without{0, 0, 0, 0, 0, {}};
  {
    AttributeWeights with = without;
    with.target = 3;
    const Mesh mesh = mesh_of(morph_grid(20));
    CHECK(mean_of(measure_attributes(mesh, level_of(mesh, 200, with)), "TARGET_0:POSITION") <
          0.5 * mean_of(measure_attributes(mesh, level_of(mesh, 200, without)), "TARGET_0:POSITION"));
  }
  {
    AttributeWeights with = without;
    with.normal = 2;
    const Mesh mesh = mesh_of(faceted_sphere(3));
    CHECK(mean_of(measure_attributes(mesh, level_of(mesh, 400, with)), "NORMAL") <
          mean_of(measure_attributes(mesh, level_of(mesh, 400, without)), "NORMAL"));
  }
}

TEST_CASE("a morph target that reaches a weight costs what its displacements times that weight would") {
  const Mesh mesh = mesh_of(morph_grid(20));
  Mesh displaced = mesh;
  for (std::size_t at = 0; at < displaced.attributes[0].data.size(); at += sizeof(float)) {
    float value = 0;
    std::memcpy(&value, &displaced.attributes[0].data[at], sizeof value);
    value *= 8;
    std::memcpy(&displaced.attributes[0].data[at], &value, sizeof value);
  }
  AttributeWeights reaching, of_others;
  reaching.target_reach = {8};
  of_others.target_reach = {1, 8};
  const auto positions = [](const Mesh& of, const AttributeWeights& weights) {
    return level_of(of, 100, weights).positions;
  };
  CHECK(positions(mesh, reaching) == positions(displaced, {}));
  CHECK(positions(mesh, of_others) == positions(mesh, {}));
  CHECK(positions(mesh, of_others) != positions(mesh, reaching));
}

}  // namespace lodestone::test

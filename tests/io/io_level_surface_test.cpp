// A level as one mesh is what readers find in a file of that level, without the file.

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/pipeline/build_asset.h>

#include "support/data.h"

namespace lodestone::test {
namespace {

/// The bytes of all that a mesh has at a corner, attributes by their names.
std::string corner_bytes(const Mesh& mesh, Index corner) {
  const Index wedge = mesh.corner_wedge[corner];
  std::string bytes(reinterpret_cast<const char*>(&mesh.positions[mesh.wedge_vertex[wedge]]), sizeof(Vec3f));
  for (const Attribute& a : mesh.attributes) {
    const std::size_t size = a.element_bytes();
    bytes += a.name;
    bytes.append(reinterpret_cast<const char*>(a.data.data()) + wedge * size, size);
  }
  return bytes;
}

/// A mesh's faces, whatever the order of faces, of vertices, and of the corners of a face.
std::vector<std::string> faces_of(const Mesh& mesh) {
  std::vector<std::string> faces;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    std::array<std::string, 3> corners;
    for (Index i = 0; i < 3; ++i) corners[i] = corner_bytes(mesh, 3 * face + i);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    faces.push_back(std::to_string(mesh.material_of(face)) + corners[0] + corners[1] + corners[2]);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

Mesh surface_in_file(const Scene& scene, const std::vector<LeveledMesh>& meshes, std::size_t level) {
  AssetOptions options;
  options.compression = Compression::None;
  return read_mesh_bytes(encode_scene_level(scene, meshes, level, options).value().glb, "glb").value().mesh;
}

void check_levels(const std::filesystem::path& path) {
  INFO(path.string());
  const Scene scene = Scene::read(path).value();
  BuildOptions options;
  options.targets = ratio_targets(0.3, 2);
  options.placement = Placement::Subset;
  options.keep_levels = true;
  options.storage.compression = Compression::None;  // what Draco does to normals, a second file would mend
  const BuildResult built = build_asset(scene, options).value();
  REQUIRE(built.decoded.size() == scene.meshes().size());
  for (std::size_t level = 0; level < built.levels.size(); ++level) {
    INFO("level " << level);
    const Mesh surface = level_surface(scene, built.decoded, level).value();
    CHECK(surface.face_count() > 0);
    CHECK((faces_of(surface) == faces_of(surface_in_file(scene, built.decoded, level))));
  }
}

TEST_CASE("a level as one mesh has the faces that a file of the level has: the demo's model") {
  check_levels(demo_model());
}

TEST_CASE("a level as one mesh has the faces that a file of the level has: skins, targets, materials, instances") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  for (const char* name :
       {"gltf/cakeBirthday.glb", "gltf/Lantern/Lantern_nobasecolor.gltf", "gltf/MultiUVTest/MultiUVTest.gltf",
        "gltf/VertexColorTest/VertexColorTest.gltf", "gltf/chr_knight.glb", "skin-morph/RobotExpressive.glb",
        "skin-morph/AnimatedMorphCube/AnimatedMorphCube.gltf", "skin-morph/MorphStressTest.gltf",
        "field/coincident-skinned.glb", "field/vertex-colours.obj", "field/mesh_with_colors.off",
        "nasty/boxNotManifold.glb"})
    if (const auto path = model(name)) check_levels(*path);
}

}  // namespace
}  // namespace lodestone::test

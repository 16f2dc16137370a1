// Two readers of one file, tinygltf's and ours, must see the same triangles.

#include <cstdio>
#include <string>

#include <lodestone/io/scene.h>
#include <lodestone/io/tinygltf_model.h>
#include <lodestone/io/write_mesh.h>

#include "support/data.h"
#include "support/tinygltf.h"

namespace lodestone::test {
namespace {

void check_agreement(const tinygltf::Model& model, const Scene& scene) {
  const std::vector<PlacedTriangles> theirs = placed_triangles(model);
  REQUIRE(theirs.size() == scene.meshes().size());
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    INFO("mesh " << i << " '" << scene.meshes()[i].name << "', " << theirs[i].size() << " triangles");
    CHECK((theirs[i] == placed_triangles(scene.meshes()[i].mesh)));
  }
}

bool uses(const EncodedAsset& asset, const std::string& extension) {
  const std::string_view text(reinterpret_cast<const char*>(asset.glb.data()), asset.glb.size());
  return text.find('"' + extension + '"') != text.npos;
}

struct Counts {
  int compared = 0, draco = 0, refused_by_both = 0, broken = 0;
};

/// What keeps tinygltf from a file must be Draco, or what keeps us from it, too. What it loads and we do not must name
/// elements that are not there.
void compare_file(const std::filesystem::path& path, Counts& counts) {
  INFO(path.string());
  const EncodedAsset asset = asset_of(path);
  const auto model = model_from_asset(asset);
  const auto scene = Scene::read(path);
  if (model && scene) {
    check_agreement(*model, *scene);
    ++counts.compared;
    return;
  }
  if (model) {
    std::printf("not compared: %s\n", scene.error().message.c_str());
    INFO(scene.error().message);
    CHECK(scene.error().code == ErrorCode::Malformed);
    CHECK_THROWS_AS(placed_triangles(*model), std::out_of_range);
    ++counts.broken;
    return;
  }
  INFO(model.error().message);
  std::printf("not compared: %s: %s\n", path.filename().c_str(), model.error().message.c_str());
  if (uses(asset, "KHR_draco_mesh_compression")) {
    CHECK(model.error().code == ErrorCode::Unsupported);
    CHECK_THAT(model.error().message, contains("Draco"));
    ++counts.draco;
  } else {
    CHECK_FALSE(scene);
    ++counts.refused_by_both;
  }
}

}  // namespace

TEST_CASE("tinygltf sees the triangles of what write_mesh writes") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    const auto glb = write_mesh_bytes(mesh, "shape.glb");
    REQUIRE(glb);
    const auto model = model_from_asset({*glb, {}, {}});
    INFO((model ? "" : model.error().message));
    REQUIRE(model);
    const std::vector<PlacedTriangles> theirs = placed_triangles(*model);
    CHECK(theirs.size() == (mesh.face_count() > 0 ? 1 : 0));
    if (!theirs.empty()) CHECK((theirs[0] == placed_triangles(mesh)));
    check_agreement(*model, Scene::read_bytes(*glb, "glb").value());
  }
}

TEST_CASE("tinygltf and the library see the same triangles in every model that tinygltf loads") {
  Counts counts;
  compare_file(demo_model(), counts);
  CHECK(counts.draco == 1);
  LODESTONE_SKIP_WITHOUT_MODELS();
  int files = 1;
  for (const std::filesystem::path& path : mesh_files("")) {
    if (path.extension() != ".glb" && path.extension() != ".gltf") continue;
    compare_file(path, counts);
    ++files;
  }
  std::printf("%d files: %d compared, %d only in Draco, %d refused by both, %d loaded by tinygltf alone\n", files,
              counts.compared, counts.draco, counts.refused_by_both, counts.broken);
  CHECK(counts.compared > files / 2);
  CHECK(counts.compared + counts.draco + counts.refused_by_both + counts.broken == files);
}

}  // namespace lodestone::test

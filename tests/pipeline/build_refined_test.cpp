// Files of one coarse level and a compact stream that refines it to the whole.

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <lodestone/core/parallel.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/file.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/pipeline/build_asset.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/deviations.h"
#include "support/gltf_shapes.h"
#include "support/mesh_properties.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

BuildOptions refined(double ratio = 0.1) {
  BuildOptions options;
  options.layout = FileLayout::Refined;
  options.targets = ratio_targets(ratio, 1);
  return options;
}

BuildOptions stream_alone() {
  BuildOptions options;
  options.layout = FileLayout::StreamAlone;
  options.targets = ratio_targets(0.3, 1);
  return options;
}

Scene scene_of(const TriangleSoup& soup) { return Scene::from_mesh({mesh_of(soup), {}, {}, {}, {}}, "shape").value(); }

BuildResult built(const Scene& scene, const BuildOptions& options) {
  auto result = build_asset(scene, options);
  INFO((result ? std::string() : result.error().message));
  REQUIRE(result);
  REQUIRE(result->files.size() == 1);
  return std::move(*result);
}

std::vector<Asset::Stream> streams_of(const BuildResult& result) {
  return Asset::read_bytes(result.files[0].glb).value().streams().value();
}

Mesh refined_to_the_end(const std::vector<std::byte>& stream) {
  return extract_level(read_stream(stream).value(), kNoIndex);
}

/// Whether meshes have the same positions, bit for bit, in any order.
bool has_floats_of(const Mesh& mesh, const Mesh& other) {
  const auto sorted = [](const Mesh& of) {
    std::multiset<std::array<float, 3>> positions;
    for (const Vec3f& p : of.positions) positions.insert({p.x, p.y, p.z});
    return positions;
  };
  return sorted(mesh) == sorted(other);
}

TriangleSoup bumpy_ball() { return icosphere(kReduced ? 2 : 3, 0.02, 7); }

const std::vector<TriangleSoup>& shapes() {
  constexpr int kSide = kReduced ? 8 : 12;
  static const std::vector<TriangleSoup> kAll = {bumpy_ball(),
                                                 terrain(kReduced ? 10 : 16, 3),
                                                 seam_sphere(kReduced ? 12 : 16, kSide),
                                                 two_material_grid(kSide),
                                                 skinned_cylinder(kReduced ? 12 : 16, kReduced ? 6 : 9),
                                                 morph_grid(kSide),
                                                 slit_grid(kSide)};
  return kAll;
}

}  // namespace

TEST_CASE("a refined file shows one level, and its stream leads to the whole mesh within its grid") {
  int off = 0;
  for (const TriangleSoup& soup : shapes()) {
    const Scene scene = scene_of(soup);
    const Mesh& whole = scene.meshes()[0].mesh;
    const BuildResult result = built(scene, refined());
    REQUIRE(result.levels.size() == 2);
    CHECK(result.levels[0].face_count == whole.face_count());
    CHECK(result.levels[1].face_count <= std::max<std::size_t>(whole.face_count() / 10, 1));

    const Asset asset = Asset::read_bytes(result.files[0].glb).value();
    REQUIRE(asset.level_count() == 1);
    CHECK(asset.levels().value()[0].face_count == result.levels[1].face_count);
    const std::vector<Asset::Stream> streams = streams_of(result);
    REQUIRE(streams.size() == 1);
    CHECK(streams[0].bytes.size() == result.levels[0].bytes);
    const Mesh last = refined_to_the_end(streams[0].bytes);
    CHECK(last.face_count() == whole.face_count());
    CHECK(last.wedge_count() == whole.wedge_count());
    CHECK(last.attributes.size() == whole.attributes.size());
    const double step = bounding_box(whole).diagonal() / ((1 << 14) - 1);
    CHECK(largest_deviation(last, whole) <= step);
    CHECK(result.levels[0].deviation.maximum() <= step);
    CHECK(result.levels[1].deviation.maximum() <= 1.01 * result.levels[1].deviation_bound + step);

    // What the file says of the level that it shows is what was measured.
    const Asset::Level shown = asset.levels().value()[0];
    const Deviation& d = result.levels[1].deviation;
    CHECK(shown.maximum_deviation == Approx(d.maximum()));
    off += shown.maximum_deviation > 0 ? 1 : 0;
    CHECK(shown.mean_deviation == Approx(std::max(d.forward.mean, d.backward.mean)));
    CHECK(shown.rms_deviation == Approx(std::max(d.forward.rms, d.backward.rms)));
    CHECK(shown.curvature_error == Approx(result.levels[1].curvature_error));
  }
  CHECK(off >= 5);  // flat ones are not
}

TEST_CASE(
    "streams of files with all levels are compact, and keep floats where that is asked for or no grid is fine enough") {
  const auto keeps_floats = [](const Scene& scene, const BuildOptions& options) {
    const BuildResult result = built(scene, options);
    const std::vector<Asset::Stream> streams = streams_of(result);
    REQUIRE(streams.size() == 1);
    const GltfFile file = GltfFile::from_glb(result.files[0].glb);
    const GltfJson& extension = file.json["meshes"][0]["extensions"]["LODESTONE_removal_stream"];
    CHECK(!extension.contains("deviation"));  // the mesh is the finest level
    const int major = stream_version(streams[0].bytes);
    CHECK(extension["version"] == std::to_string(major) + ".0");
    CHECK(major == 3);
    const Mesh last = refined_to_the_end(streams[0].bytes);
    CHECK(last.face_count() == scene.meshes()[0].mesh.face_count());
    return has_floats_of(scene.meshes()[0].mesh, last);
  };
  const Scene ball = scene_of(bumpy_ball());
  BuildOptions usual;
  CHECK(!keeps_floats(ball, usual));
  for (const int levels : {1, 2}) {  // a file of one level is one to build from, too
    usual.targets = ratio_targets(0.5, levels - 1);
    CHECK(!keeps_floats(ball, usual));
    const auto again = Scene::read_bytes(built(ball, usual).files[0].glb, "glb");
    CHECK(again.has_value() == (levels == 1));
  }
  BuildOptions lossless = usual, plain = usual, fine = usual, coarse = usual, gridded = usual, close = usual;
  lossless.lossless = true;
  CHECK(keeps_floats(ball, lossless));
  plain.storage.compression = Compression::None;
  CHECK(keeps_floats(ball, plain));
  fine.storage.position_bits = 17;
  CHECK(keeps_floats(ball, fine));
  coarse.storage.position_bits = 6;
  CHECK(!keeps_floats(ball, coarse));
  gridded.storage.position_grid = PositionGrid{{}, 0.001F};
  CHECK(keeps_floats(ball, gridded));
  close.targets = {{TargetKind::Error, 1e-6, false, false}};
  CHECK(keeps_floats(ball, close));

  // A shape that is far longer than thick.
  TriangleSoup rod = icosphere(kReduced ? 2 : 3, 0, 7);
  for (Vec3f& p : rod.positions) p = {p.x * 1000, p.y * 0.01F, p.z * 0.01F};
  CHECK(keeps_floats(scene_of(rod), usual));
  for (const BuildOptions& drawn : {refined(), stream_alone()}) {
    const auto last = [&](const TriangleSoup& soup, bool is_lossless) {
      BuildOptions options = drawn;
      options.lossless = is_lossless;
      const Scene scene = scene_of(soup);
      const BuildResult result = built(scene, options);
      const bool is_alone = options.layout == FileLayout::StreamAlone;
      return has_floats_of(scene.meshes()[0].mesh,
                           refined_to_the_end(is_alone ? result.files[0].glb : streams_of(result)[0].bytes));
    };
    CHECK(last(rod, false));
    CHECK(last(bumpy_ball(), true));
    CHECK(!last(bumpy_ball(), false));
  }
}

TEST_CASE("the levels of a file do not hang on whether its stream is compact") {
  const Scene scene = scene_of(seam_sphere(16, 12));
  BuildOptions lossless;
  lossless.lossless = true;
  const auto levels = [&](const BuildOptions& options) {
    const Asset asset = Asset::read_bytes(built(scene, options).files[0].glb).value();
    const std::vector<Asset::Level> read = asset.levels().value();
    std::vector<std::vector<Vec3f>> positions;
    for (const Asset::Level& level : read) positions.push_back(level.mesh.positions);
    return positions;
  };
  const auto usual = levels({});
  CHECK(usual.size() > 2);
  CHECK((usual == levels(lossless)));
}

TEST_CASE("a stream alone leads to the mesh, through the levels that it is measured at") {
  for (const TriangleSoup& soup : shapes()) {
    const Scene scene = scene_of(soup);
    const Mesh& whole = scene.meshes()[0].mesh;
    BuildOptions options;
    options.layout = FileLayout::StreamAlone;
    options.targets = ratio_targets(0.3, 1);
    options.material_numbers = {7, 3};
    options.keep_levels = true;
    const BuildResult result = built(scene, options);
    REQUIRE(result.levels.size() == 2);
    CHECK(result.levels[1].face_count <= result.levels[0].face_count * 3 / 10);
    const std::vector<std::byte>& bytes = result.files[0].glb;
    CHECK(result.stream.bytes == bytes.size());
    CHECK(result.levels[0].bytes == bytes.size());
    CHECK(result.levels[1].bytes <= bytes.size());
    const ProgressiveMesh mesh = read_stream(bytes).value();
    CHECK(mesh.groups[0].material == 7);
    if (mesh.groups.size() > 1) CHECK(mesh.groups[1].material == 3);
    const Mesh last = extract_level(mesh, kNoIndex);
    CHECK(last.face_count() == whole.face_count());
    CHECK(largest_deviation(last, whole) <= 2 * result.quantisation_error);
    CHECK(result.levels[0].deviation.maximum() <= 2 * result.quantisation_error);
    CHECK(result.levels[1].deviation.maximum() <= 1.01 * result.levels[1].deviation_bound);
    for (std::size_t i = 0; i < 2; ++i) {
      const Mesh& level = result.decoded[0].levels[i].mesh;
      CHECK(level.face_count() == result.levels[i].face_count);
      for (const Index material : level.face_material) CHECK(material < scene.meshes()[0].materials.size());
    }
  }
}

TEST_CASE("a stream alone is of one mesh, and compact streams have 8 to 16 bits") {
  const Scene scene = scene_of(icosphere(2, 0.02, 7));
  BuildOptions options;
  options.layout = FileLayout::StreamAlone;
  for (const int bits : {7, 17}) {
    options.storage.position_bits = bits;
    CHECK(build_asset(scene, options).error().code == ErrorCode::InvalidArgument);
    BuildOptions other = refined();
    other.storage.position_bits = bits;
    CHECK(build_asset(scene, other).error().code == ErrorCode::InvalidArgument);
  }
  options.storage.position_bits = 16;
  CHECK(build_asset(scene, options).value().position_bits == 16);
  GltfMaker maker;
  for (const char* name : {"one", "two"}) add_node(maker, name, add_mesh(maker, name, cube(1)));
  const auto two = build_asset(Scene::read_bytes(maker.glb(), "glb").value(), options);
  REQUIRE_FALSE(two);
  CHECK_THAT(two.error().message, contains("of one mesh, not of 2"));
}

TEST_CASE("a refined file names its stream's version, and is no original to build from") {
  const BuildResult result = built(scene_of(terrain(8, 1)), refined());
  const GltfFile file = GltfFile::from_glb(result.files[0].glb);
  const GltfJson& extension = file.json["meshes"][0]["extensions"]["LODESTONE_removal_stream"];
  CHECK(extension["version"] == "3.0");
  CHECK(file.view_bytes(extension["bufferView"]) == streams_of(result)[0].bytes);
  CHECK(file.json.dump().find("MSFT_lod") == std::string::npos);
  const auto again = Scene::read_bytes(result.files[0].glb, "glb");
  REQUIRE_FALSE(again);
  CHECK(again.error().code == ErrorCode::Unsupported);
  CHECK_THAT(again.error().message, contains("build from the original"));
  const auto scene = Asset::read_bytes(result.files[0].glb).value().scene();
  REQUIRE(scene);
  CHECK(scene->meshes()[0].stream == streams_of(result)[0].bytes);
}

TEST_CASE("meshes that touch share their stream's grid, so that no crack opens at the end") {
  GltfMaker maker;
  const TriangleSoup soup = terrain(12, 5);
  for (const bool left : {true, false}) {
    TriangleSoup half = soup;
    half.indices.clear();
    for (std::size_t f = 0; f < soup.indices.size(); f += 3) {
      const float x = (soup.positions[soup.indices[f]].x + soup.positions[soup.indices[f + 1]].x +
                       soup.positions[soup.indices[f + 2]].x) /
                      3;
      if ((x < 0.5F) == left)
        half.indices.insert(half.indices.end(), {soup.indices[f], soup.indices[f + 1], soup.indices[f + 2]});
    }
    add_node(maker, left ? "left" : "right", add_mesh(maker, left ? "left" : "right", half));
  }
  const Scene scene = Scene::read_bytes(maker.glb(), "glb").value();
  REQUIRE(scene.meshes().size() == 2);
  const std::vector<Asset::Stream> streams = streams_of(built(scene, refined()));
  REQUIRE(streams.size() == 2);
  const auto at_border = [](const Mesh& mesh) {
    std::set<std::array<float, 3>> places;
    for (const Vec3f& p : mesh.positions)
      if (std::abs(p.x - 0.5F) < 1e-3F) places.insert({p.x, p.y, p.z});
    return places;
  };
  const auto left = at_border(refined_to_the_end(streams[0].bytes));
  CHECK(left.size() == 13);
  CHECK(left == at_border(refined_to_the_end(streams[1].bytes)));
}

TEST_CASE("what a refined file shows has something of each primitive, so that its stream's faces have a place") {
  TriangleSoup soup = icosphere(3, 0.02, 1);
  soup.face_material.assign(soup.indices.size() / 3, 1);
  const TriangleSoup small = tetrahedron();
  const auto first = static_cast<Index>(soup.positions.size());
  for (const Vec3f& p : small.positions) soup.positions.push_back({3 + p.x * 0.01F, p.y * 0.01F, p.z * 0.01F});
  for (const Index i : small.indices) soup.indices.push_back(first + i);
  soup.face_material.resize(soup.indices.size() / 3, 0);
  for (const bool vanish : {false, true}) {
    BuildOptions options = refined(vanish ? 0 : 0.02);
    options.simplify.vanish = vanish;
    const BuildResult result = built(scene_of(soup), options);
    const GltfFile file = GltfFile::from_glb(result.files[0].glb);
    CHECK(file.json["meshes"][0]["primitives"].size() == 2);
    const Asset asset = Asset::read_bytes(result.files[0].glb).value();
    CHECK(asset.levels().value()[0].face_count == result.levels.back().face_count);
    const Scene shown = asset.scene().value();
    const Mesh last = refined_to_the_end(shown.meshes()[0].stream);
    CHECK(std::set<Index>(last.face_material.begin(), last.face_material.end()) == std::set<Index>{0, 1});
    CHECK(level_surface(shown, std::vector{LeveledMesh{{AssetLevel{last, {}, 0, "whole"}}, {}}}, 0).has_value());
  }
}

TEST_CASE("a refined file's first picture comes within its limit, unless the level was asked for") {
  const Scene scene = scene_of(terrain(40, 3));
  BuildOptions options = refined(0.9);
  const BuildResult result = built(scene, options);
  const AssetLayout& layout = result.files[0].layout;
  CHECK(layout.first_picture_bytes <= 4096);
  CHECK(layout.first_picture_bytes > 3000);
  const GltfFile file = GltfFile::from_glb(result.files[0].glb);
  const GltfJson& draco = file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  const GltfJson& view = file.json["bufferViews"][draco["bufferView"].get<std::size_t>()];
  const std::size_t binary = file.json["buffers"][0]["byteLength"], begin = view.value("byteOffset", std::size_t{0});
  const std::size_t end = begin + view["byteLength"].get<std::size_t>();
  CHECK(layout.first_picture_bytes == result.files[0].glb.size() - (binary + 3) / 4 * 4 + end);
  const Asset asset = Asset::read_bytes(result.files[0].glb).value();
  CHECK(asset.levels().value()[0].face_count == result.levels[1].face_count);
  CHECK(result.meshes[0].levels.size() == 2);
  CHECK(result.levels[1].face_count < scene.meshes()[0].mesh.face_count() / 2);
  CHECK(asset.levels().value()[0].maximum_deviation == Approx(result.levels[1].deviation.maximum()));

  options.targets[0].is_wish = false;
  const BuildResult asked = built(scene, options);
  CHECK(asked.files[0].layout.first_picture_bytes > 4096);
  CHECK(asked.levels[1].face_count > scene.meshes()[0].mesh.face_count() / 2);
}

TEST_CASE("a stream alone has a first picture early, though all of it vanishes at once") {
  TriangleSoup soup;
  const TriangleSoup piece = icosphere(0, 0.05, 3);
  for (int i = 0; i < 300; ++i) {
    const auto first = static_cast<Index>(soup.positions.size());
    for (const Vec3f& p : piece.positions)
      soup.positions.push_back({p.x + 3 * static_cast<float>(i % 10), p.y + 3 * static_cast<float>(i / 10), p.z});
    for (const Index index : piece.indices) soup.indices.push_back(first + index);
  }
  const Scene scene = scene_of(soup);
  BuildOptions options = stream_alone();
  options.placement = Placement::Subset;  // placed levels end chunks, too
  const BuildResult result = built(scene, options);
  const auto ends_of_first_chunk = [](const std::vector<std::byte>& stream) {
    const CompactChunk first = read_compact_chunks(stream).value()[0];
    return first.byte_offset + first.byte_length;
  };
  CHECK(ends_of_first_chunk(encode_compact(result.simplified[0].mesh, {}).value().bytes) > 4096);
  const std::vector<std::byte>& stream = result.files[0].glb;
  CHECK(ends_of_first_chunk(stream) <= 4096);
  CHECK(ends_of_first_chunk(stream) > 1000);
  const Mesh& whole = scene.meshes()[0].mesh;
  const Mesh last = refined_to_the_end(stream);
  CHECK(last.face_count() == whole.face_count());
  CHECK(largest_deviation(last, whole) <= bounding_box(whole).diagonal() / ((1 << 14) - 1));
}

TEST_CASE("a refined .gltf has its streams beside it, which readers find") {
  const Scene scene = scene_of(seam_sphere(16, 12));
  BuildOptions options = refined();
  options.storage.gltf_name = "a ball";
  const BuildResult result = built(scene, options);
  const ScratchDirectory folder;
  REQUIRE(write_file(folder / "a ball.gltf", result.files[0].glb));
  std::uint64_t bytes = result.files[0].glb.size();
  for (const AssetFile& file : result.files[0].beside) {
    REQUIRE(write_file(folder / file.path.string(), file.bytes));
    bytes += file.bytes.size();
  }
  CHECK(std::filesystem::exists(folder / "a ball.lods"));
  const Asset asset = Asset::read(folder / "a ball.gltf").value();
  CHECK(asset.total_bytes() == bytes);
  const auto streams = asset.streams();
  REQUIRE(streams);
  CHECK(refined_to_the_end((*streams)[0].bytes).face_count() == scene.meshes()[0].mesh.face_count());
  CHECK(asset.scene().value().meshes()[0].stream == (*streams)[0].bytes);
  std::filesystem::remove(folder / "a ball.lods");
  CHECK_FALSE(Asset::read(folder / "a ball.gltf").value().streams());
}

TEST_CASE("a refined file is the same for any number of threads") {
  const Scene scene = scene_of(seam_sphere(16, 12));
  std::vector<std::vector<std::byte>> files;
  for (const std::size_t threads : {1, 2, 5})
    with_threads(threads, [&] { files.push_back(built(scene, refined()).files[0].glb); });
  CHECK(files[0] == files[1]);
  CHECK(files[0] == files[2]);
}

TEST_CASE("what a refined file cannot have is refused and named") {
  const Scene scene = scene_of(terrain(8, 1));
  BuildOptions two = refined();
  two.targets = ratio_targets(0.5, 2);
  const auto refused = build_asset(scene, two);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::InvalidArgument);
  CHECK_THAT(refused.error().message, contains("2 targets"));
  BuildOptions grid = refined();
  grid.storage.position_grid = PositionGrid{{}, 0.01F};
  CHECK(build_asset(scene, grid).error().code == ErrorCode::Unsupported);
}

}  // namespace lodestone::test

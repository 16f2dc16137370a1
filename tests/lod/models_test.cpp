// Every readable model, through the stream and back: nothing is lost.

#include <lodestone/io/read_mesh.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

constexpr std::size_t kMostFaces = kReduced ? 3000 : 500'000;

SimplifyResult simplified(const Mesh& mesh) {
  SimplifyOptions options;
  options.measure_step = 0;  // the records are the same; measuring is tested elsewhere
  auto result = simplify(mesh, options);
  REQUIRE(result);
  return std::move(*result);
}

void check_recovery(const Mesh& mesh, const SimplifyResult& result) {
  const auto bytes = encode_stream(result.mesh);
  REQUIRE(bytes);
  const auto decoded = decode_stream(*bytes);
  INFO((decoded ? "" : decoded.error().message));
  REQUIRE(decoded);
  Cursor cursor(*decoded);
  cursor.seek(static_cast<Index>(decoded->record_count()));
  CHECK(triangle_set(extract_level(*decoded, cursor)) == triangle_set(mesh));
}

/// What keeps a mesh from a ratio is one piece that no legal removal makes smaller: few faces, or most edges already
/// joined.
void check_ratios(const Mesh& mesh, const SimplifyResult& result) {
  const std::size_t fewest = face_counts(result.mesh).front();
  const BlockedCounts& blocked = result.blocked;
  CHECK(fewest > 0);
  CHECK(blocked.locked + blocked.flip + blocked.link + blocked.shape + blocked.texture + blocked.ring ==
        result.mesh.base_vertex_count);
  for (const double ratio : {0.5, 0.1}) {
    const auto faces = static_cast<std::size_t>(ratio * static_cast<double>(mesh.face_count()));
    if (fewest > faces) CHECK((fewest <= 20 || blocked.link > result.mesh.base_vertex_count / 2));
  }
}

}  // namespace

TEST_CASE("every readable model comes back from its stream bit for bit, and says what keeps it from a ratio") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  std::size_t readable = 0;
  for (const auto& path : mesh_files("")) {
    INFO(path.string());
    const auto file = read_mesh(path);
    if (!file || file->mesh.face_count() > kMostFaces) continue;
    ++readable;
    const SimplifyResult result = simplified(file->mesh);
    check_recovery(file->mesh, result);
    if (file->mesh.face_count() > 0) check_ratios(file->mesh, result);
  }
  CHECK(readable > 30);
}

TEST_CASE("a rod that is all slivers reaches every ratio") {
  const auto path = model("field/rod-64-sides.obj");
  LODESTONE_SKIP_UNLESS(path, "no models: set LODESTONE_DATA to their folder");
  const auto file = read_mesh(*path);
  REQUIRE(file);
  const auto result = simplify(file->mesh);
  REQUIRE(result);
  CHECK(face_counts(result->mesh).front() <= 8);
}

TEST_CASE("a file of random winding has no cuts, and reaches every ratio") {
  const auto path = model("field/oblong-shuffled.off");
  LODESTONE_SKIP_UNLESS(path, "no models: set LODESTONE_DATA to their folder");
  const auto file = read_mesh(*path);
  REQUIRE(file);
  CHECK(file->assembly.turned_faces > 0);
  CHECK(file->assembly.nonmanifold_edges + file->assembly.cut_vertices == 0);
  const auto result = simplify(file->mesh);
  REQUIRE(result);
  CHECK(face_counts(result->mesh).front() <= 8);
  Cursor cursor(result->mesh);
  cursor.seek(position_for_faces(result->mesh, 420));
  const Mesh level = extract_level(result->mesh, cursor);
  CHECK(level.face_count() == 420);
  CHECK(measure_deviation(file->mesh, level).backward.mean < 2e-4 * bounding_box(file->mesh).diagonal());
}

TEST_CASE("a part from engineering, all needles, keeps to a hundredth of a percent at half of its faces") {
  const auto path = model("field/cad-part.obj");
  LODESTONE_SKIP_UNLESS(path, "no models: set LODESTONE_DATA to their folder");
  const auto file = read_mesh(*path);
  REQUIRE(file);
  const double diagonal = bounding_box(file->mesh).diagonal();
  const auto result = simplify(file->mesh);
  REQUIRE(result);
  Cursor cursor(result->mesh);
  for (const auto& [faces, most] : {std::pair{1500, 2e-5}, {1000, 5e-5}, {890, 5e-5}, {445, 2e-4}}) {
    INFO(faces << " faces");
    if (kReduced && faces != 890) continue;
    cursor.seek(position_for_faces(result->mesh, static_cast<std::uint64_t>(faces)));
    const Mesh level = extract_level(result->mesh, cursor);
    for (const Mesh& mesh : {level, optimise_placement(file->mesh, level)}) {
      const Deviation deviation = measure_deviation(file->mesh, mesh);
      CHECK(deviation.maximum() < most * diagonal);
      CHECK(deviation.mean_normal_angle < 0.01);
    }
  }
}

TEST_CASE("the model that comes with the repository comes back from its stream bit for bit") {
  const auto file = read_mesh(demo_model());
  REQUIRE(file);
  REQUIRE(file->mesh.face_count() > 0);
  if (file->mesh.face_count() <= kMostFaces) check_recovery(file->mesh, simplified(file->mesh));
}

}  // namespace lodestone::test

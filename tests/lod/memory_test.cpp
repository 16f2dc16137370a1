// How much memory structures and whole jobs take, by operators new and delete that count. The figures are those of the
// table "Memory" in bench/README.md: change both together.

#include <lodestone/core/connectivity.h>
#include <lodestone/core/parallel.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/lod/surface_index.h>
#include <lodestone/pipeline/build_asset.h>

#include "distance/face_boxes.h"
#include "distance/level_deviation.h"
#include "distance/patch_bound.h"
#include "distance/surface_walk.h"
#include "simplify/carried_points.h"
#include "support/catch.h"
#include "support/counted_memory.h"
#include "support/data.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

constexpr double kTolerance = 1.04;

/// Bytes for each face of the mesh.
struct Memory {
  double stays = 0;  ///< what the result takes
  double peak = 0;   ///< the most at any time on the way to it
};

template <class Make>
Memory memory_of(const Mesh& mesh, const Make& make) {
  const std::size_t before = live_bytes;
  peak_bytes = before;
  [[maybe_unused]] const auto made = make();
  const auto faces = static_cast<double>(mesh.face_count());
  return {static_cast<double>(live_bytes - before) / faces, static_cast<double>(peak_bytes - before) / faces};
}

/// A closed surface: half as many vertices as faces, as many wedges as vertices, no attributes.
Mesh ball() { return assemble(icosphere(kReduced ? 4 : 6, 0.01, 7))->mesh; }

SimplifyOptions measured_each(double step) {
  SimplifyOptions options;
  options.measure_step = step;
  return options;
}

}  // namespace

TEST_CASE("structures take the bytes that the table says") {
  const Mesh mesh = ball();
  CHECK(memory_of(mesh, [&] { return Mesh(mesh); }).stays <= 20 * kTolerance);
  CHECK(memory_of(mesh, [&] { return *Connectivity::build(mesh); }).stays <= 26 * kTolerance);
  CHECK(memory_of(mesh, [&] { return detail::CarriedPoints(mesh); }).stays <= 40 * kTolerance);
  CHECK(memory_of(mesh, [&] { return SurfaceIndex(mesh); }).stays <= 92 * kTolerance);
  CHECK(memory_of(mesh, [&] { return detail::SurfaceWalk(mesh); }).stays <= 136 * kTolerance);
  CHECK(memory_of(mesh, [&] { return detail::FaceBoxes(mesh); }).stays <= 3.5 * kTolerance);
  CHECK(memory_of(mesh, [&] { return detail::opposite_corners(mesh); }).stays <= 12 * kTolerance);
  CHECK(memory_of(mesh, [&] { return detail::LevelDeviation(mesh, {}); }).stays <= 68 * kTolerance);
  CHECK(memory_of(mesh, [&] { return LevelFitter(mesh); }).stays <= 144 * kTolerance);
  const SimplifyOptions unmeasured = measured_each(0);
  CHECK(memory_of(mesh, [&] { return simplify(mesh, unmeasured); }).stays <= 51 * kTolerance);
}

// Smaller meshes are dominated by what does not grow with them.
#ifndef LODESTONE_TEST_REDUCED
TEST_CASE("whole jobs take no more at their peak than the table says") {
  const Mesh mesh = ball();
  with_threads(1, [&] {
    CHECK(memory_of(mesh, [&] { return simplify(mesh, measured_each(0)); }).peak <= 174 * kTolerance);
    CHECK(memory_of(mesh, [&] { return simplify(mesh, measured_each(0.1)); }).peak <= 276 * kTolerance);
    const Result<SimplifyResult> result = simplify(mesh, measured_each(0));
    REQUIRE(result);
    const Mesh half = extract_level(result->mesh, position_for_faces(result->mesh, mesh.face_count() / 2));
    const LevelFitter fitter(mesh);
    CHECK(memory_of(mesh, [&] { return fitter.fit(half); }).peak <= 529 * kTolerance);
    CHECK(memory_of(mesh, [&] { return measure_deviation(mesh, half); }).peak <= 389 * kTolerance);
  });
}

TEST_CASE("a build takes no more at its peak than the table says") {
  const Mesh mesh = ball();
  const Scene scene = Scene::from_mesh({mesh, {}, {}, {}, {}}, "ball").value();
  BuildOptions options;
  options.effort = 2;
  with_threads(1,
               [&] { CHECK(memory_of(mesh, [&] { return build_asset(scene, options); }).peak <= 700 * kTolerance); });
}
#endif

}  // namespace lodestone::test

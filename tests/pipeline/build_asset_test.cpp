#include <lodestone/pipeline/build_asset.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/parallel.h>
#include <lodestone/lod/cursor.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/random.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

Scene scene_of(const TriangleSoup& soup) {
  return Scene::from_mesh({assemble(soup)->mesh, {}, {}, {}, {}}, "shape").value();
}

Scene ball_scene() { return scene_of(icosphere(kReduced ? 2 : 3, 0.02, 7)); }

/// Keeps what a build says, and wants no more from some call on.
struct Watcher : BuildObserver {
  bool progress(BuildStage stage, double done) override {
    said[stage].push_back(done);
    return ++calls < last_call;
  }

  std::map<BuildStage, std::vector<double>> said;
  std::size_t calls = 0;
  std::size_t last_call = static_cast<std::size_t>(-1);
};

BuildOptions options_of(FileLayout layout) {
  BuildOptions options;
  options.layout = layout;
  return options;
}

}  // namespace

TEST_CASE("a build says how far it is: each stage from 0 to 1, never back") {
  const Scene scene = ball_scene();
  for (const FileLayout layout :
       {FileLayout::OneFile, FileLayout::FilePerLevel, FileLayout::Refined, FileLayout::StreamAlone}) {
    Watcher watcher;
    BuildOptions options = options_of(layout);
    if (layout == FileLayout::Refined) options.targets = ratio_targets(0.1, 1);
    const auto built = build_asset(scene, options, watcher);
    REQUIRE(built);
    CHECK(built->met);
    CHECK(built->files.size() == (layout == FileLayout::FilePerLevel ? built->levels.size() : 1));
    REQUIRE(watcher.said.size() == 4);
    for (const auto& [stage, shares] : watcher.said) {
      CAPTURE(static_cast<int>(stage));
      CHECK(shares.front() == 0);
      CHECK(shares.back() == Approx(1));
      CHECK(std::is_sorted(shares.begin(), shares.end()));
    }
  }
}

TEST_CASE("a build can be cancelled at any of its calls, and makes no other then") {
  const Scene scene = ball_scene();
  Random random(12);
  BuildOptions refined = options_of(FileLayout::Refined);
  refined.targets = ratio_targets(0.1, 1);
  for (const BuildOptions& options : {BuildOptions{}, refined, options_of(FileLayout::StreamAlone)}) {
    Watcher whole;
    REQUIRE(build_asset(scene, options, whole));
    std::vector<std::size_t> chosen = {1, 2, whole.calls};
    while (chosen.size() < (kReduced ? 5 : 30)) chosen.push_back(1 + random.below(whole.calls));
    for (const std::size_t call : chosen)
      for (const std::size_t threads : {1, 3}) {
        CAPTURE(call, whole.calls, threads);
        Watcher watcher;
        watcher.last_call = call;
        with_threads(threads, [&] {
          const auto built = build_asset(scene, options, watcher);
          REQUIRE_FALSE(built);
          CHECK(built.error().code == ErrorCode::Cancelled);
        });
        CHECK(watcher.calls == call);
      }
  }
}

TEST_CASE("a stream is heard of while it is encoded") {
  const Scene scene = Scene::from_mesh({assemble(icosphere(4, 0.02, 7))->mesh, {}, {}, {}, {}}, "ball").value();
  BuildOptions options = options_of(FileLayout::Refined);
  options.targets = ratio_targets(0.1, 1);
  Watcher watcher;
  REQUIRE(build_asset(scene, options, watcher));
  std::size_t count = 0;  // of calls before files are written
  for (const double done : watcher.said[BuildStage::Writing]) count += done < 0.3 ? 1 : 0;
  CHECK(count > 50);
}

TEST_CASE("a build is heard of within a mesh: no stage but writing goes far between two calls") {
  const Scene scene =
      Scene::from_mesh({assemble(icosphere(kReduced ? 4 : 5, 0.02, 7))->mesh, {}, {}, {}, {}}, "ball").value();
  Watcher watcher;
  REQUIRE(build_asset(scene, {}, watcher));
  for (const BuildStage stage : {BuildStage::Simplifying, BuildStage::MakingLevels, BuildStage::MeasuringLevels}) {
    CAPTURE(static_cast<int>(stage));
    const std::vector<double>& shares = watcher.said[stage];
    double farthest = 0;
    for (std::size_t i = 0; i + 1 < shares.size(); ++i) farthest = std::max(farthest, shares[i + 1] - shares[i]);
    CHECK(farthest < 0.201);  // the whole mesh, one of five levels, takes that much at once
    CHECK(shares.size() > 50);
  }
}

TEST_CASE("who listens to a build changes nothing in it") {
  const Scene scene = ball_scene();
  Watcher watcher;
  const auto heard = build_asset(scene, {}, watcher), alone = build_asset(scene);
  REQUIRE(heard);
  REQUIRE(alone);
  CHECK(heard->files[0].glb == alone->files[0].glb);
}

TEST_CASE("targets of any order are levels finest first, those of two kinds are refused") {
  const Scene scene = ball_scene();
  BuildOptions options;
  options.targets = {{TargetKind::Faces, 40, false, false}, {TargetKind::Faces, 0.5, true, false}};
  const auto built = build_asset(scene, options);
  REQUIRE(built);
  REQUIRE(built->levels.size() == 3);
  CHECK(built->levels[1].face_count > built->levels[2].face_count);
  CHECK(built->levels[2].face_count <= 40);
  options.targets.push_back({TargetKind::Error, 0.1, false, false});
  const auto mixed = build_asset(scene, options);
  REQUIRE_FALSE(mixed);
  CHECK(mixed.error().code == ErrorCode::InvalidArgument);
}

TEST_CASE("a strict build of what cannot be met encodes nothing") {
  const Scene scene = ball_scene();
  BuildOptions options;
  options.targets = {{TargetKind::Faces, 1, false, false}};
  options.strict = true;
  const auto built = build_asset(scene, options);
  REQUIRE(built);
  CHECK_FALSE(built->met);
  CHECK(built->files.empty());
  options.strict = false;
  const auto written = build_asset(scene, options);
  REQUIRE(written);
  CHECK_FALSE(written->met);
  CHECK(written->files.size() == 1);
}

TEST_CASE("names that nothing in the scene has are refused") {
  BuildOptions options;
  options.importance.materials["nowhere"].lock = true;
  const auto built = build_asset(ball_scene(), options);
  REQUIRE_FALSE(built);
  CHECK_THAT(built.error().message, contains("'nowhere'"));
}

TEST_CASE("the levels a build keeps are those it measured, and any number of threads makes the same") {
  const Scene scene = ball_scene();
  BuildOptions options;
  options.keep_levels = true;
  std::vector<EncodedAsset> files;
  for (const std::size_t threads : {1, 3})
    with_threads(threads, [&] {
      const auto built = build_asset(scene, options);
      REQUIRE(built);
      REQUIRE(built->decoded.size() == 1);
      REQUIRE(built->decoded[0].levels.size() == built->levels.size());
      for (std::size_t i = 0; i < built->levels.size(); ++i)
        CHECK(built->decoded[0].levels[i].mesh.face_count() == built->levels[i].face_count);
      files.push_back(built->files[0]);
    });
  CHECK(files[0].glb == files[1].glb);
}

TEST_CASE("an effort out of its range is refused with the number") {
  BuildOptions options;
  for (const int effort : {0, 10, -1}) {
    options.effort = effort;
    const auto built = build_asset(ball_scene(), options);
    REQUIRE(!built);
    CHECK(built.error().code == ErrorCode::InvalidArgument);
    CHECK(built.error().message.find(std::to_string(effort)) != std::string::npos);
  }
}

TEST_CASE("each effort makes the levels asked for, with bounds that hold") {
  const Scene scene = ball_scene();
  for (const int effort : {kLeastEffort, 2, 4, kDefaultEffort, kMostEffort}) {
    BuildOptions options;
    options.effort = effort;
    options.placement = Placement::Subset;
    options.keep_levels = true;
    options.storage.compression = Compression::None;
    const auto built = build_asset(scene, options);
    REQUIRE(built);
    INFO("effort " << effort);
    CHECK(built->met);
    REQUIRE(built->levels.size() == 5);
    for (std::size_t i = 1; i < built->levels.size(); ++i) {
      CHECK(built->levels[i].face_count <= built->levels[i - 1].face_count / 2);
      CHECK(built->levels[i].deviation.maximum() <= 1.0001 * static_cast<double>(built->levels[i].deviation_bound));
    }
  }
}

TEST_CASE("what a build says of errors is true at the least efforts, and as tight as they promise") {
  for (const TriangleSoup& soup :
       {icosphere(kReduced ? 2 : 4, 0.02, 7), terrain(kReduced ? 12 : 40, 3), torus(kReduced ? 12 : 32, 16),
        cube(kReduced ? 4 : 10), seam_sphere(kReduced ? 12 : 24, kReduced ? 8 : 16)}) {
    DeviationOptions maxima;  // by search: samples are for means
    maxima.sample_count = 100;
    const Scene scene = scene_of(soup);
    const Mesh& whole = scene.meshes()[0].mesh;
    for (const auto& [effort, tolerance] : {std::pair{1, 0.1}, std::pair{2, 0.05}}) {
      BuildOptions options;
      options.effort = effort;
      options.keep_levels = true;
      const auto built = build_asset(scene, options);
      REQUIRE(built);
      for (std::size_t i = 0; i < built->levels.size(); ++i) {
        CAPTURE(effort, whole.face_count(), i);
        const Deviation said = built->meshes[0].levels[i].deviation;
        const Deviation really = measure_deviation(whole, built->decoded[0].levels[i].mesh, maxima);
        CHECK(said.maximum_bound() >= really.maximum());
        CHECK(said.maximum() <= really.maximum_bound());
        CHECK(said.maximum_bound() <= (1 + tolerance) * said.maximum() + 1e-6 * bounding_box(whole).diagonal());
        const ProgressiveMesh& stream = built->simplified[0].mesh;
        const auto position = static_cast<Index>(stream.record_count() / (i + 2));
        const auto bound = static_cast<double>(stream.deviation[position]);
        CHECK(bound >= measure_deviation(whole, extract_level(stream, position), maxima).maximum());
      }
    }
  }
}

TEST_CASE("no effort takes fewer samples than a smaller one, of a level") {
  const Scene scene = ball_scene();
  std::size_t before = 0;
  for (int effort = kLeastEffort; effort <= kMostEffort; ++effort) {
    CAPTURE(effort);
    BuildOptions options;
    options.effort = effort;
    options.placement = Placement::Subset;
    options.stream = false;
    options.targets = ratio_targets(0.5, 1);
    const auto built = build_asset(scene, options);
    REQUIRE(built);
    const OneSidedDeviation& forward = built->levels[0].deviation.forward;
    CHECK(forward.sample_count >= before);
    before = forward.sample_count;
  }
}

TEST_CASE("streams are coded fast by the least efforts, where nothing else is asked for") {
  BuildOptions options;
  for (const auto& [effort, coding] : {std::pair{1, CompactCoding::Fast}, std::pair{2, CompactCoding::Fast},
                                       std::pair{3, CompactCoding::Small}, std::pair{9, CompactCoding::Small}}) {
    options.effort = effort;
    options.stream_coding.reset();
    CHECK(stream_coding_of(options) == coding);
    for (const CompactCoding asked : {CompactCoding::Small, CompactCoding::Fast}) {
      options.stream_coding = asked;
      CHECK(stream_coding_of(options) == asked);
    }
  }
}

}  // namespace lodestone::test

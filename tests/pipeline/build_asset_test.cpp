#include <lodestone/pipeline/build_asset.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <lodestone/core/parallel.h>

#include "support/catch.h"
#include "support/data.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

Scene ball_scene() {
  return Scene::from_mesh({assemble(icosphere(kReduced ? 2 : 3, 0.02, 7))->mesh, {}, {}, {}, {}}, "ball").value();
}

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
  for (const FileLayout layout : {FileLayout::OneFile, FileLayout::FilePerLevel}) {
    Watcher watcher;
    const auto built = build_asset(scene, options_of(layout), watcher);
    REQUIRE(built);
    CHECK(built->met);
    CHECK(built->files.size() == (layout == FileLayout::OneFile ? 1 : built->levels.size()));
    REQUIRE(watcher.said.size() == 4);
    for (const auto& [stage, shares] : watcher.said) {
      CAPTURE(static_cast<int>(stage));
      CHECK(shares.front() == 0);
      CHECK(shares.back() == Approx(1));
      CHECK(std::is_sorted(shares.begin(), shares.end()));
    }
  }
}

TEST_CASE("a build can be cancelled at any of its calls") {
  const Scene scene = ball_scene();
  Watcher whole;
  REQUIRE(build_asset(scene, {}, whole));
  for (std::size_t call = 1; call <= whole.calls; ++call) {
    CAPTURE(call, whole.calls);
    Watcher watcher;
    watcher.last_call = call;
    const auto built = build_asset(scene, {}, watcher);
    REQUIRE_FALSE(built);
    CHECK(built.error().code == ErrorCode::Cancelled);
  }
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
    options.storage.draco = false;
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

}  // namespace lodestone::test

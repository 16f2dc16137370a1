// Builds a multi-LOD asset through the library, shows how far it is, and cancels a second build half-way.
//
//   build IN OUT.glb

#include <cstdio>

#include <lodestone/io/file.h>
#include <lodestone/pipeline/build_asset.h>

namespace {

struct Watcher : lodestone::BuildObserver {
  bool progress(lodestone::BuildStage stage, double done) override {
    std::printf("stage %d: %.0f %%\n", static_cast<int>(stage), 100 * done);
    return !(cancels && stage == lodestone::BuildStage::MakingLevels);
  }
  bool cancels = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const lodestone::Result<lodestone::Scene> scene = lodestone::Scene::read(argv[1]);
  if (!scene) return std::fprintf(stderr, "%s\n", scene.error().message.c_str()), 1;
  Watcher watcher;
  const auto built = lodestone::build_asset(*scene, {}, watcher);
  if (!built || !lodestone::write_file(argv[2], built->files[0].glb)) return 1;
  for (const auto& level : built->levels) std::printf("%zu faces, %g\n", level.face_count, level.deviation.maximum());
  watcher.cancels = true;
  const auto cancelled = lodestone::build_asset(*scene, {}, watcher);
  return !cancelled && cancelled.error().code == lodestone::ErrorCode::Cancelled ? 0 : 1;
}

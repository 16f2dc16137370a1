// The jobs whose instructions are counted, see count_instructions.sh: one thread, always the same input.
//
//   speed_jobs simplify|build

#include <cstdio>
#include <string>

#include <lodestone/core/parallel.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_asset.h>

#include "support/shapes.h"

namespace lodestone::test {
namespace {

/// Hills of 7,200 faces, to the base mesh, each record with its bound. Returns whether it came to its end.
bool run_simplify() {
  const Result<AssembledMesh> hills = assemble(terrain(60, 1));
  return hills && simplify(hills->mesh);
}

/// The demo's model: a level, the stream, measured errors.
bool run_build() {
  const Result<Scene> scene = Scene::read(LODESTONE_SOURCE_DIR "/demo/suzi.glb");
  BuildOptions options;
  options.targets = ratio_targets(0.2, 1);
  return scene && build_asset(*scene, options);
}

int run(const std::string& job) {
  bool ok = false;
  with_threads(1, [&] { ok = job == "simplify" ? run_simplify() : job == "build" && run_build(); });
  if (!ok) std::fprintf(stderr, "speed_jobs: '%s' did not come to its end\n", job.c_str());
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace lodestone::test

int main(int argc, char** argv) { return lodestone::test::run(argc > 1 ? argv[1] : ""); }

#include <filesystem>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/gltf_file.h"
#include "support/program.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

/// A scene of several balls, each finer than the one before: work for several threads.
std::string write_balls(const ScratchDirectory& folder, int count) {
  GltfMaker maker;
  maker.json["scene"] = 0;
  GltfJson roots = GltfJson::array();
  for (int i = 0; i < count; ++i) {
    const Mesh ball = assemble(icosphere(1 + i % 3, 0.02, 7))->mesh;
    std::vector<float> positions;
    for (const Vec3f& p : ball.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
    std::vector<std::uint32_t> indices;
    for (Index corner = 0; corner < 3 * ball.face_count(); ++corner) indices.push_back(ball.corner_vertex(corner));
    const std::size_t position = maker.add_floats(positions, "VEC3", 3);
    const std::size_t index = maker.add_accessor(indices, 5125, "SCALAR", 1);
    const std::size_t mesh =
        maker.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", index}}}}});
    roots.push_back(maker.add("nodes", {{"mesh", mesh}, {"translation", {4 * i, 0, 0}}}));
  }
  maker.add("scenes", {{"nodes", roots}});
  std::string path = (folder / "balls.glb").string();
  const ByteVector glb = maker.glb();
  write_text(path, {reinterpret_cast<const char*>(glb.data()), glb.size()});
  return path;
}

}  // namespace

TEST_CASE("any number of threads gives the same bytes") {
  const ScratchDirectory folder;
  const std::string input = write_balls(folder, kReduced ? 3 : 6);
  std::vector<std::string> files;
  for (const char* threads : {"1", "2", "5"}) {
    const std::string output = (folder / (std::string(threads) + ".glb")).string();
    REQUIRE(run_program({"build", input, output, "--threads", threads, "--quiet"}).exit_code == 0);
    files.push_back(file_text(output));
  }
  CHECK(files[0] == files[1]);
  CHECK(files[0] == files[2]);
  CHECK(run_program({"build", input, "o.glb", "--threads", "0"}).exit_code == 1);
}

// Address sanitizers reserve terabytes: no limit on them can be set.
#ifndef LODESTONE_TEST_REDUCED
TEST_CASE("where memory ends, in any thread, the program says so and writes nothing") {
  const ScratchDirectory folder;
  const std::string input = write_balls(folder, 6), output = (folder / "out.glb").string();
  std::size_t fewest = 0;
  bool was_enough = false;
  for (std::size_t megabytes = 16; megabytes <= 1024 && !was_enough; megabytes += megabytes / 4) {
    CAPTURE(megabytes);
    const ProgramRun run =
        run_program({"build", input, output, "--threads", "4", "--quiet"}, "/dev/null", megabytes << 20);
    was_enough = run.exit_code == 0;
    if (was_enough || run.exit_code == 127) continue;  // 127: too little to load the program
    ++fewest;
    CHECK(run.exit_code == 2);
    const bool is_said = run.err == "lodestone: error: out of memory\n" ||
                         run.err.find("pthread_create") != std::string::npos;  // of oneTBB, where a thread has no room
    CAPTURE(run.err);
    CHECK(is_said);
    CHECK_FALSE(std::filesystem::exists(output));
  }
  CHECK(was_enough);
  CHECK(fewest > 0);
}
#endif

}  // namespace lodestone::test

// What becomes of every broken file among the models: the faces that are kept, or the message that names the problem.

#include <map>

#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"

namespace lodestone::test {
namespace {

struct Outcome {
  const char* file;
  int exit_code;      ///< 0: built
  std::size_t faces;  ///< that the whole mesh has
  const char* says;   ///< part of what is printed as a warning or error; "" for nothing
};

constexpr Outcome kOutcomes[] = {
    {"nasty/boxNotManifold.glb", 0, 12, ""},
    {"nasty/degenerate_mesh.obj", 2, 0, "two corners at one position"},
    {"nasty/double_sided.obj", 0, 4, "1 edge cut: not manifold"},
    {"nasty/empty.obj", 2, 0, "no triangles to simplify"},
    {"nasty/empty.stl", 2, 0, "no triangles to simplify"},
    {"nasty/eof_test.obj", 0, 1, ""},
    {"nasty/extra_vertex.obj", 0, 3, "9 normals without a direction were computed"},
    {"nasty/hull-mask.obj", 0, 7980, ""},
    {"nasty/inf_nan.obj", 2, 0, "a corner is not finite"},
    {"nasty/joined_tetrahedra.obj", 0, 8, "3 vertices cut: several sheets met there"},
    {"nasty/multibody.stl", 0, 32, "26 faces turned to wind as their neighbours do"},
    {"nasty/multiple_isolated_triangles.obj", 0, 5, ""},
    {"nasty/negative_indices.obj", 0, 12, ""},
    {"nasty/non_manifold_wrap.obj", 0, 12, "1 edge cut: not manifold"},
    {"nasty/notenoughindices.obj", 0, 1, "1 faces with fewer than three corners"},
    {"nasty/quadknot.obj", 0, 2880, "no library at hand describes"},
    {"nasty/self_intersectA.obj", 0, 17160, ""},
    {"nasty/soup.stl", 0, 100, ""},
    {"nasty/zero_area_face.obj", 0, 1, ""},
    {"gltf-invalid/IndexOutOfRange/AllIndicesOutOfRange.gltf", 2, 0, "index 0 is 65535, the primitive restart value"},
    {"gltf-invalid/IndexOutOfRange/IndexOutOfRange.gltf", 2, 0, "index 0 is 255: there are 24 vertices"},
    {"gltf-invalid/MissingBin/BoxTextured.gltf", 2, 0, "buffer 0: cannot read"},
    {"gltf-invalid/accessor_data/get_elements.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/get_elements_matrix.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/get_elements_sparse.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/invalid_elements_float.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/out_of_range_elements_float.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/out_of_range_elements_sint16.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/out_of_range_elements_sint8.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/out_of_range_elements_uint16.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/out_of_range_elements_uint32.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/accessor_data/out_of_range_elements_uint8.gltf", 2, 0, "the file has no meshes"},
    {"gltf-invalid/mesh_data/colors_non_clamped.gltf", 2, 0, "no nodes to show its meshes"},
    {"gltf-invalid/mesh_data/index_buffer_degenerate_triangle.gltf", 2, 0, "no nodes to show its meshes"},
    {"gltf-invalid/mesh_data/index_buffer_oob.gltf", 2, 0, "no nodes to show its meshes"},
    {"gltf-invalid/mesh_data/index_buffer_primitive_restart.gltf", 2, 0, "no nodes to show its meshes"},
    {"gltf-invalid/mesh_data/joints_no_weights.gltf", 2, 0, "no node of a scene shows a mesh with triangles"},
    {"gltf-invalid/mesh_data/joints_weights_complex.gltf", 2, 0, "no node of a scene shows a mesh with triangles"},
    {"gltf-invalid/mesh_data/normals_tangents_non_unit_invalid_sign.gltf", 2, 0, "no nodes to show its meshes"},
};

void check(const Outcome& expected, const std::filesystem::path& path) {
  INFO(expected.file);
  const ScratchDirectory folder;
  const std::string glb = (folder / "out.glb").string();
  const std::string report = (folder / "r.json").string();
  const ProgramRun run = run_program({"build", path.string(), "-o", glb, "--report", report, "--quiet"});
  INFO(run.err);
  REQUIRE(run.exit_code == expected.exit_code);
  CHECK_THAT(run.err, contains(expected.says));
  CHECK(names_in(folder.path()) ==
        (run.exit_code == 0 ? std::vector<std::string>{"out.glb", "r.json"} : std::vector<std::string>{}));
  if (run.exit_code != 0) return;
  CHECK(nlohmann::json::parse(file_text(report))["levels"][0]["faces"] == expected.faces);
  const std::string whole = (folder / "whole.ply").string();
  CHECK(run_program({"extract", glb, "--error", "0", "-o", whole, "--quiet"}).exit_code == 0);
}

}  // namespace

TEST_CASE("every broken file among the models has the outcome that the table says") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  for (const Outcome& expected : kOutcomes) {
    if (kReduced && expected.faces > 5000) continue;
    if (const auto path = model(expected.file)) check(expected, *path);
  }
}

TEST_CASE("the table leaves out none of the broken files") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  for (const char* folder : {"nasty", "gltf-invalid"})
    for (const auto& path : mesh_files(folder)) {
      const bool known = std::any_of(std::begin(kOutcomes), std::end(kOutcomes),
                                     [&](const Outcome& outcome) { return path.string().ends_with(outcome.file); });
      INFO(path.string());
      CHECK(known);
    }
}

}  // namespace lodestone::test

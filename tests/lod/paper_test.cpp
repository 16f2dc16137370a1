// What the project promises on the paper's two models, measured against the original, both ways.

#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

Mesh read(const std::string& name) {
  auto file = read_mesh(*model("paper/" + name + ".obj"));
  REQUIRE(file);
  return std::move(file->mesh);
}

ProgressiveMesh simplified(const Mesh& mesh, Metric metric) {
  SimplifyOptions options;
  options.metric = metric;
  options.measure_step = metric == Metric::Hybrid ? options.measure_step : 0;
  auto result = simplify(mesh, options);
  REQUIRE(result);
  return std::move(result->mesh);
}

Deviation deviation_at(const Mesh& full, const ProgressiveMesh& mesh, Index position) {
  Cursor cursor(mesh);
  cursor.seek(position);
  return measure_deviation(full, extract_level(mesh, cursor));
}

bool within(double value, double target, double tolerance) { return std::abs(value - target) <= tolerance * target; }

}  // namespace

TEST_CASE("the pure curvature metrics give the errors found for them, within 25 %") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  LODESTONE_SKIP_UNLESS(!kReduced, "full-size models in the release build only");
  struct Row {
    const char* name;
    Metric metric;
    std::uint64_t faces;
    double mean, maximum;
  };
  for (const Row& row : {Row{"fandisk", Metric::Gaussian, 258, 0.0072, 0.095},
                         Row{"stanford-bunny", Metric::Mean, 855, 0.00081, 0.0048}}) {
    INFO(row.name);
    const Mesh full = read(row.name);
    const ProgressiveMesh mesh = simplified(full, row.metric);
    const Deviation deviation = deviation_at(full, mesh, position_for_faces(mesh, row.faces));
    CAPTURE(deviation.forward.mean, deviation.forward.maximum);
    CHECK(within(deviation.forward.mean, row.mean, 0.25));
    CHECK(within(deviation.forward.maximum, row.maximum, 0.25));
  }
}

TEST_CASE("the default metric keeps close to the paper's models, both ways, borders included") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  LODESTONE_SKIP_UNLESS(!kReduced, "full-size models in the release build only");
  struct Row {
    const char* name;
    std::uint64_t faces;
    double mean, maximum;
    std::uint64_t faces_at_a_thousandth;  // of the diagonal
  };
  for (const Row& row : {Row{"fandisk", 258, 0.0042, 0.07, 800}, Row{"stanford-bunny", 855, 0.00036, 0.0030, 16000}}) {
    INFO(row.name);
    const Mesh full = read(row.name);
    const ProgressiveMesh mesh = simplified(full, Metric::Hybrid);
    const Deviation deviation = deviation_at(full, mesh, position_for_faces(mesh, row.faces));
    CHECK(deviation.forward.mean <= row.mean);
    CHECK(deviation.backward.mean <= row.mean);
    CHECK(deviation.maximum() < row.maximum);

    // Whatever error is asked for, over four decades, is kept.
    const double diagonal = bounding_box(full).diagonal();
    for (const double error : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
      const Index position = position_for_deviation(mesh, error * diagonal);
      CAPTURE(error, position);
      CHECK(deviation_at(full, mesh, position).maximum() <= error * diagonal);
    }
    // And costs no more faces than it must: one vertex let go too early, as at a short border, would keep thousands.
    CHECK(face_counts(mesh)[position_for_deviation(mesh, 1e-3 * diagonal)] <= row.faces_at_a_thousandth);
  }
}

}  // namespace lodestone::test

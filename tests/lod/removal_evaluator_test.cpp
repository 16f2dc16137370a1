#include "simplify/removal_evaluator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "distance/point_triangle.h"
#include "simplify/angles.h"
#include "simplify/creases.h"
#include "simplify/filling_distances.h"
#include "support/catch.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

using namespace detail;

Vec3 random_point(Random& random) { return {random.signed_unit(), random.signed_unit(), random.signed_unit()}; }

}  // namespace

TEST_CASE("angles are as near to the true ones as is said, all the way round") {
  std::vector<double> cosine, sine, expected;
  const auto add = [&](double angle, double scale) {
    cosine.push_back(scale * std::cos(angle)), sine.push_back(std::abs(scale * std::sin(angle)));
    expected.push_back(std::atan2(sine.back(), cosine.back()));
  };
  for (int i = 0; i <= 3000; ++i)
    for (const double scale : {1.0, 1e-30, 1e30}) add(std::numbers::pi * i / 3000, scale);
  cosine.push_back(0), sine.push_back(0), expected.push_back(0);
  std::vector<double> found(expected.size());
  angles(found.size(), cosine.data(), sine.data(), found.data());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - expected[i]) < 3e-10);
}

TEST_CASE("the distance to a filling is the least of those to its triangles, whichever others are measured") {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const int size = 3 + static_cast<int>(random.below(5));
    std::vector<Vec3> corners;
    for (int i = 0; i < size; ++i) corners.push_back(random_point(random));
    if (trial % 10 == 0) corners[1] = corners[0];  // a triangle that is none
    PointBatch points;
    const std::size_t count = 1 + random.below(40);
    for (std::size_t i = 0; i < count; ++i) points.add(random_point(random) * 2);
    FillingDistances distances;
    distances.clear();
    std::vector<int> fillings;
    for (std::size_t k = 0; k < kMostMeasured; ++k) {
      fillings.push_back(static_cast<int>(random.below(static_cast<std::size_t>(triangulation_count(size)))));
      distances.add(triangulation(size, fillings.back()));
    }
    distances.measure(points, corners);
    for (std::size_t k = 0; k < fillings.size(); ++k) {
      const float* found = distances.to(k);
      std::vector<float> expected(points.padded_size(), 1e9F), one(points.padded_size());
      for (const PolygonTriangle t : triangulation(size, fillings[k])) {
        squared_distances(points, std::array{corners[t.a], corners[t.b], corners[t.c]}, one.data());
        for (std::size_t i = 0; i < one.size(); ++i) expected[i] = std::min(expected[i], one[i]);
      }
      for (std::size_t i = 0; i < count; ++i) CHECK(std::abs(found[i] - expected[i]) < 1e-4F * (1 + expected[i]));
    }
  }
}

TEST_CASE("plain stars are judged by the same rules and charged the same on the short path and on the long one") {
  std::size_t legal = 0;
  for (const NamedShape& shape : manifold_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    INFO(shape.name);
    for (const int effort : {1, 3, 9}) {
      SimplifyOptions options;
      options.effort = effort;
      auto connectivity = Connectivity::build(mesh);
      REQUIRE(connectivity);
      mark_creases(mesh, options, *connectivity);
      SimplifyState state{mesh, std::move(*connectivity), CarriedPoints(mesh), {}, {}, {}, {}};
      gather_curvature(state, options);
      const AttributeCost attributes(mesh, options.weights);
      const FaceRules rules(mesh);
      RemovalEvaluator one_way(state, options, attributes, rules);
      RemovalEvaluator other_way(state, options, attributes, rules, false);
      for (Index v = 0; v < mesh.vertex_count(); ++v) {
        if (!state.connectivity.has_vertex(v) || state.connectivity.site(v) != v) continue;
        Choice first{kNoChoice, kNoChoice}, second = first;
        const Evaluation found = one_way.evaluate(v, first);
        const Evaluation expected = other_way.evaluate(v, second);
        CAPTURE(effort, v, static_cast<int>(found.verdict), static_cast<int>(expected.verdict));
        CHECK(rejects(found.verdict) == rejects(expected.verdict));
        if (rejects(expected.verdict)) continue;
        CHECK(found.cost == Approx(expected.cost).epsilon(1e-3).margin(1e-5));
        legal += first[1] == kPlain ? 1 : 0;
      }
    }
  }
  CHECK(legal > 1000);
}

}  // namespace lodestone::test

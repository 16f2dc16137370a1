// Levels one after the other against every pair of faces, and against the measure that starts afresh.

#include <lodestone/lod/level_deviation.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/deviations.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

constexpr std::size_t kMostFaces = kReduced ? 60 : 160;  // of what is measured against all pairs of faces

/// A mesh and levels of it: first finer and finer, then coarser and coarser, then in no order.
struct Levels {
  std::string name;
  Mesh mesh;
  std::vector<Mesh> levels;
};

/// Those of all families of at most kMostFaces faces.
std::vector<Levels> small_levels() {
  std::vector<Levels> all;
  for (const NamedShape& shape : all_shapes()) {
    Levels entry{shape.name, mesh_of(shape.soup), {}};
    if (entry.mesh.face_count() == 0 || entry.mesh.face_count() > kMostFaces) continue;
    const SimplifyResult result = simplify(entry.mesh).value();
    const auto count = static_cast<double>(result.mesh.record_count());
    for (const double share : {0.0, 0.3, 0.9, 1.0, 0.6, 0.5, 0.0, 0.7, 0.2}) {
      Mesh level = extract_level(result.mesh, static_cast<Index>(share * count));
      if (level.face_count() > 0) entry.levels.push_back(std::move(level));
    }
    all.push_back(std::move(entry));
  }
  return all;
}

/// The range of the supremum, from the distances to all faces.
SampledSupremum brute_force(const Mesh& from, const Mesh& to) {
  return sample_supremum(
      from, [&](const Vec3& p) { return distance_to_all(p, to); }, 4);
}

double diagonal_of(const Mesh& mesh) { return bounding_box(mesh).diagonal(); }

void check_equal(const Deviation& a, const Deviation& b) {
  CHECK(a.forward.maximum == b.forward.maximum);
  CHECK(a.forward.maximum_bound == b.forward.maximum_bound);
  CHECK(a.backward.maximum == b.backward.maximum);
  CHECK(a.backward.maximum_bound == b.backward.maximum_bound);
}

}  // namespace

TEST_CASE("a mesh does not deviate from itself, first or after other levels") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    const double nothing = allowed(0, {}, diagonal_of(mesh));
    LevelDeviation levels(mesh);
    CHECK(levels.measure(mesh).maximum_bound() <= nothing);
    levels.measure(shifted(mesh, 0.2F, 0, 0.1F));
    CHECK(levels.measure(mesh).maximum_bound() <= nothing);
    CHECK(levels.measure(mesh, 0).maximum_bound() <= nothing);
  }
}

TEST_CASE("each way, the maximum lies between its bounds as all pairs of faces have it, whatever was measured before") {
  for (const auto& [name, mesh, levels] : small_levels()) {
    INFO(name);
    LevelDeviation deviation(mesh);
    for (const Mesh& level : levels) {
      INFO("level of " << level.face_count() << " faces");
      const Deviation found = deviation.measure(level);
      check_contains(found.forward, brute_force(mesh, level));
      check_contains(found.backward, brute_force(level, mesh));
      CHECK(found.maximum_bound() <= allowed(found.maximum(), {}, diagonal_of(mesh)));
    }
  }
}

TEST_CASE("mesh and level change sides: what is forward for one is backward for the other") {
  for (const auto& [name, mesh, levels] : small_levels()) {
    INFO(name);
    for (const Mesh& level : levels) {
      const Deviation there = LevelDeviation(mesh).measure(level), back = LevelDeviation(level).measure(mesh);
      CHECK(overlap(there, back));
      CHECK(there.forward.maximum <= back.backward.maximum_bound + 1e-12);
      CHECK(back.forward.maximum <= there.backward.maximum_bound + 1e-12);
      CHECK(there.backward.maximum <= back.forward.maximum_bound + 1e-12);
      CHECK(back.backward.maximum <= there.forward.maximum_bound + 1e-12);
    }
  }
}

TEST_CASE("levels measured one after the other agree with each on its own") {
  const std::vector<NamedShape> shapes = all_shapes();
  for (const NamedShape& shape : shapes) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    const double diagonal = bounding_box(mesh).diagonal();
    std::vector<Mesh> levels = {mesh, with_holes(mesh, 0.1, 1), with_holes(mesh, 0.1, 2)};
    for (const double cell : {0.01, 0.02, 0.05, 0.06, 0.1, 0.2, 0.05})
      levels.push_back(clustered(mesh, cell * diagonal));
    levels.push_back(shifted(mesh, 0.1F, 0, 0));
    levels.push_back(shifted(mesh, 0, 0.4F, 0));
    levels.push_back(mesh);

    DeviationOptions options;
    options.relative_tolerance = 0.01;
    LevelDeviation with_moves(mesh, options);
    LevelDeviation without_moves(mesh, options);
    const MeasuredSurface original(mesh);
    const Mesh* last = nullptr;
    for (const Mesh& level : levels) {
      INFO(shape.name << ", level of " << level.face_count() << " faces");
      double moved = kInfinity;
      if (last && last->face_count() > 0)
        moved = measure_maximum(MeasuredSurface(*last), MeasuredSurface(level), options).forward.maximum_bound;
      last = &level;
      const Deviation alone = measure_maximum(original, MeasuredSurface(level), options);
      for (const Deviation& found : {with_moves.measure(level, moved), without_moves.measure(level)}) {
        CHECK(overlap(found, alone));
        if (level.face_count() > 0) CHECK(found.maximum_bound() <= allowed(found.maximum(), options, diagonal));
      }
    }
  }
}

TEST_CASE("what is enough is shown and no more, and the bound stays true for the levels that follow, too") {
  for (const auto& [name, mesh, levels] : small_levels()) {
    INFO(name);
    LevelDeviation deviation(mesh);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const double exact = LevelDeviation(mesh).measure(levels[i]).maximum();
      const double enough = (i % 3 == 0 ? 4 : i % 3 == 1 ? 1.5 : 0.5) * exact;
      const Deviation found = deviation.measure(levels[i], kInfinity, enough);
      CHECK(found.maximum_bound() >= exact * (1 - 1e-9) - 1e-12);
      CHECK(found.maximum() <= found.maximum_bound());
      CHECK(found.maximum_bound() <= std::max(enough, allowed(found.maximum(), {}, diagonal_of(mesh))) + 1e-12);
    }
  }
}

TEST_CASE("a spent budget gives a bound that is wide, but true") {
  for (const auto& [name, mesh, levels] : small_levels()) {
    INFO(name);
    DeviationOptions options;
    options.budget = 1;
    LevelDeviation narrow(mesh), wide(mesh, options);
    for (const Mesh& level : levels) CHECK(overlap(narrow.measure(level), wide.measure(level)));
  }
}

TEST_CASE("a measurement that is cancelled gives a bound that is wide, but true, and spoils none before") {
  for (const auto& [name, mesh, levels] : small_levels()) {
    INFO(name);
    bool is_wanted = true;
    DeviationOptions options;
    options.progress = [&](double) { return is_wanted; };
    LevelDeviation narrow(mesh), ended(mesh, options);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      is_wanted = i == 0;
      CHECK(overlap(narrow.measure(levels[i]), ended.measure(levels[i])));
    }
  }
}

TEST_CASE("the same levels in the same order give the same numbers, also where the object moves in between") {
  const Mesh mesh = mesh_of(torus(16, 8));
  const std::vector<Mesh> levels = {clustered(mesh, 0.1), clustered(mesh, 0.15), clustered(mesh, 0.3), mesh};
  LevelDeviation first(mesh), again(mesh);
  for (const Mesh& level : levels) {
    check_equal(first.measure(level), again.measure(level));
    LevelDeviation moved(std::move(again));
    again = std::move(moved);
  }
}

TEST_CASE("planes, halves and shells deviate as computed by hand, each way") {
  const Mesh square = raw_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
  const Mesh half = raw_mesh({{0, 0, 0}, {0.5F, 0, 0}, {0.5F, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
  LevelDeviation deviation(square);
  const Deviation raised = deviation.measure(shifted(square, 0, 0, 0.25F));
  for (const OneSidedDeviation& side : {raised.forward, raised.backward}) {
    CHECK(side.maximum == Approx(0.25).epsilon(1e-6));
    CHECK(side.maximum_bound == Approx(0.25).epsilon(1.1e-3));
  }
  const Deviation halved = deviation.measure(half);
  CHECK(halved.forward.maximum == Approx(0.5).epsilon(1.1e-3));
  CHECK(halved.backward.maximum < 1e-6);
  CHECK(LevelDeviation(half).measure(square).backward.maximum == Approx(0.5).epsilon(1.1e-3));

  const Mesh sphere = mesh_of(icosphere(2, 0, 1));
  Mesh shell = sphere;
  for (Vec3f& p : shell.positions) p = {1.5F * p.x, 1.5F * p.y, 1.5F * p.z};
  CHECK(LevelDeviation(sphere).measure(shell).maximum() == Approx(0.5).epsilon(0.01));
}

TEST_CASE("an empty level is infinitely far from the mesh, not from an empty one, and spoils nothing") {
  const Mesh mesh = mesh_of(tetrahedron()), moved = shifted(mesh, 0.1F, 0, 0);
  LevelDeviation levels(mesh);
  const Deviation before = levels.measure(moved);
  CHECK(levels.measure(Mesh{}).maximum() == kInfinity);
  CHECK(overlap(levels.measure(moved), before));
  levels.measure(mesh);
  levels.measure(Mesh{});
  // Having no point, it is at no distance from what follows; but nothing is known from before it.
  const Deviation after = levels.measure(moved, 0);
  CHECK(after.forward.maximum_bound >= before.forward.maximum);
  CHECK(after.backward.maximum_bound >= before.backward.maximum);
  CHECK(levels.measure(mesh).maximum_bound() < 1e-6);
  const Mesh empty;
  LevelDeviation of_empty(empty);
  CHECK(of_empty.measure(Mesh{}).maximum_bound() == 0);
  CHECK(of_empty.measure(mesh).maximum() == kInfinity);
}

}  // namespace lodestone::test

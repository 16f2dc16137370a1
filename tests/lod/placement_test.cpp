#include <lodestone/lod/placement.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <lodestone/core/parallel.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "support/cad_shapes.h"
#include "support/data.h"
#include "support/deviations.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

Mesh level_of(const Mesh& mesh, double ratio) {
  SimplifyOptions options;
  options.measure_step = 0;
  const auto result = simplify(mesh, options);
  REQUIRE(result);
  Cursor cursor(result->mesh);
  cursor.seek(
      position_for_faces(result->mesh, static_cast<std::uint64_t>(ratio * static_cast<double>(mesh.face_count()))));
  return extract_level(result->mesh, cursor);
}

double rms(const Mesh& a, const Mesh& b, const DeviationOptions& options = {}) {
  const Deviation deviation = measure_deviation(a, b, options);
  return deviation.forward.rms + deviation.backward.rms;
}

/// The faces whose normal is against that of the nearest of the original's, at all of some points.
std::size_t faces_turned_away(const Mesh& original, const Mesh& level) {
  const SurfaceIndex index(original);
  std::size_t count = 0;
  for (Index f = 0; f < level.face_count(); ++f) {
    bool away = true;
    for (std::size_t k = 0; k < 16 && away; ++k) {
      const auto hit = index.nearest(point_on_face(level, f, k), std::numeric_limits<double>::infinity());
      away = dot(area_vector(original, hit.face), area_vector(level, f)) < 0;
    }
    count += away ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("fitted levels are nearer to the original, by far on smooth surfaces") {
  for (const TriangleSoup& soup : {icosphere(4, 0, 0), torus(48, 32), terrain(40, 3)}) {
    const Mesh mesh = mesh_of(soup);
    const Mesh level = level_of(mesh, 0.08);
    const Mesh fitted = optimise_placement(mesh, level);
    CHECK(fitted.face_count() == level.face_count());
    CHECK(rms(mesh, fitted) < 0.8 * rms(mesh, level));
  }
}

TEST_CASE("fitting lets no face leave the surface, rough or smooth") {
  for (const TriangleSoup& soup : {icosphere(3, 0.1, 2), icosphere(3, 0.05, 1),
                                   torus(kReduced ? 24 : 48, kReduced ? 16 : 32), terrain(kReduced ? 24 : 40, 3)}) {
    const Mesh mesh = mesh_of(soup);
    for (const double ratio : {0.5, 0.3, 0.1}) {
      const Mesh level = level_of(mesh, ratio);
      const double before = largest_deviation(mesh, level);
      INFO(mesh.face_count() << " faces at " << ratio);
      CHECK(largest_deviation(mesh, optimise_placement(mesh, level)) < 1.3 * before);
    }
  }
}

TEST_CASE("no fitted vertex leaves the original's box by more than the level was off") {
  for (const NamedShape& shape : all_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    const Box box = bounding_box(mesh);
    for (const double ratio : {0.3, 0.1, 0.0}) {
      const Mesh level = level_of(mesh, ratio);
      if (level.face_count() == 0) continue;
      const double off = largest_deviation(mesh, level);
      double out = 0;
      for (const Vec3f& stored : optimise_placement(mesh, level).positions) {
        const Vec3 p(stored), below = box.low - p, above = p - box.high;
        out = std::max({out, below.x, below.y, below.z, above.x, above.y, above.z});
      }
      INFO(shape.name << " at " << level.face_count() << " faces, which are " << off << " off");
      CHECK(out <= 0.85 * off + 1e-6);
    }
  }
}

TEST_CASE("fitting makes fine levels nearer in mean, too, where most faces have no error at first") {
  for (const TriangleSoup& soup : {icosphere(3, 0.02, 3), torus(64, 32), terrain(40, 5)}) {
    const Mesh mesh = mesh_of(soup);
    const Mesh level = level_of(mesh, 0.5);
    const Deviation before = measure_deviation(mesh, level);
    const Deviation after = measure_deviation(mesh, optimise_placement(mesh, level));
    INFO(mesh.face_count() << " faces");
    CHECK(after.forward.mean + after.backward.mean < 0.95 * (before.forward.mean + before.backward.mean));
    CHECK(after.forward.rms + after.backward.rms < before.forward.rms + before.backward.rms);
  }
}

TEST_CASE("fitting turns no more faces away from the original than were before") {
  std::size_t before = 0;
  std::size_t after = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4})
    for (const TriangleSoup& soup : {icosphere(3, 0.15, seed), terrain(30, seed)}) {
      const Mesh mesh = mesh_of(soup);
      for (const double ratio : {0.4, 0.15, 0.05}) {
        const Mesh level = level_of(mesh, ratio);
        before += faces_turned_away(mesh, level);
        after += faces_turned_away(mesh, optimise_placement(mesh, level));
      }
    }
  CAPTURE(before, after);
  CHECK(after <= before);
}

TEST_CASE("fitting keeps the topology of every family, opens no crack and turns no face or texture over") {
  for (const NamedShape& shape : all_shapes()) {
    for (const double ratio : {0.6, 0.25}) {
      INFO(shape.name << " at " << ratio);
      const Mesh mesh = mesh_of(shape.soup);
      if (mesh.face_count() == 0) continue;
      const Mesh level = level_of(mesh, ratio);
      const Mesh fitted = optimise_placement(mesh, level);
      REQUIRE(fitted.face_count() == level.face_count());
      const auto before = assemble(to_soup(level));
      const auto after = assemble(to_soup(fitted));
      REQUIRE(before);
      REQUIRE(after);
      CHECK(after->report.nonmanifold_edges == before->report.nonmanifold_edges);
      CHECK(after->report.degenerate_faces + after->report.duplicate_faces == 0);
      CHECK(open_places(fitted).size() == open_places(level).size());
      const double scale = bounding_box(mesh).diagonal();
      for (Index f = 0; f < fitted.face_count(); ++f) CHECK(length(area_vector(fitted, f)) > 1e-12 * scale * scale);
      if (shape.name.starts_with("seam") || shape.name.starts_with("slit"))
        for (Index f = 0; f < fitted.face_count(); ++f) CHECK(texture_area(fitted, f) >= 0);
    }
  }
}

TEST_CASE("sheets that lie on one another are fitted like one of them, and lie on one another still") {
  DeviationOptions few;
  few.sample_count = 5000;
  for (const TriangleSoup& sister : {icosphere(3, 0.02, 2), torus(24, 16), terrain(20, 3)}) {
    const Mesh once = mesh_of(sister);
    const double single = rms(once, optimise_placement(once, level_of(once, 0.15)), few);
    for (const TriangleSoup& soup : {stacked(sister, 2), layered(sister, 3), two_sided(sister)}) {
      const std::size_t count = soup.indices.size() / sister.indices.size();
      INFO(once.face_count() << " faces, " << count << " sheets");
      const Mesh mesh = mesh_of(soup);
      const Mesh fitted = optimise_placement(mesh, level_of(mesh, 0.15));
      CHECK(is_layered(fitted, count));
      CHECK(rms(once, fitted, few) < 1.25 * single);
    }
  }
}

TEST_CASE("borders and corners stay: a flat square is still the same square") {
  const Mesh mesh = mesh_of(grid(12, 0, 1));
  const Mesh fitted = optimise_placement(mesh, level_of(mesh, 0.1));
  CHECK(surface_area(fitted) == Approx(1).epsilon(1e-5));
  CHECK(rms(mesh, fitted) < 1e-6);
}

TEST_CASE("levels that lie on the original stay there to the last bit that counts, and needles are fitted, too") {
  for (const TriangleSoup& soup : {cut_box(24), askew(cut_box(24)), crowded_box(6), askew(crowded_box(6))}) {
    const Mesh mesh = mesh_of(soup);
    const Mesh fitted = optimise_placement(mesh, level_of(mesh, 0.2));
    CHECK(largest_deviation(mesh, fitted) < 2e-6 * bounding_box(mesh).diagonal());
  }
  for (const TriangleSoup& soup : {rod(96), askew(rod(96)), turned_shaft(20)}) {
    const Mesh mesh = mesh_of(soup);
    const Mesh level = level_of(mesh, 0.2);
    CHECK(rms(mesh, optimise_placement(mesh, level)) < 0.95 * rms(mesh, level));
  }
}

TEST_CASE("attributes follow where vertices go, each on its side of the seam") {
  const Mesh mesh = mesh_of(seam_sphere(32, 20));
  const Mesh level = level_of(mesh, 0.15);
  const Mesh fitted = optimise_placement(mesh, level);
  const auto mean = [&](const Mesh& m, const char* name) {
    const auto all = measure_attributes(mesh, m);
    return std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name == name; })->mean;
  };
  // Normals on a sphere are its positions: the looked-up ones stay near them.
  CHECK(mean(fitted, "NORMAL") < 1.2 * mean(level, "NORMAL") + 0.01);
  CHECK(mean(fitted, "TEXCOORD_0") < 1.2 * mean(level, "TEXCOORD_0") + 0.005);
  // No wedge has a texture coordinate from the other side: faces stay small in the texture.
  for (Index f = 0; f < fitted.face_count(); ++f) CHECK(texture_area(fitted, f) < 0.1);
}

TEST_CASE("joints and weights stay those of the vertex") {
  const Mesh mesh = mesh_of(skinned_cylinder(24, 16));
  const Mesh fitted = optimise_placement(mesh, level_of(mesh, 0.3));
  for (Index w = 0; w < fitted.wedge_count(); ++w) {
    bool known = false;
    for (Index o = 0; o < mesh.wedge_count() && !known; ++o)
      known = std::memcmp(&fitted.attributes[1].data[16 * w], &mesh.attributes[1].data[16 * o], 16) == 0;
    CHECK(known);
  }
}

TEST_CASE("what is fixed stays bit for bit, and so do faces between fixed vertices, while the rest is fitted") {
  std::size_t moved = 0;
  for (const NamedShape& shape : manifold_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() < 100) continue;
    INFO(shape.name);
    const Box box = bounding_box(mesh);
    SimplifyOptions options;
    options.measure_step = 0;
    options.lock_border = true;
    for (const Vec3f& p : mesh.positions)  // a third is kept as it is
      options.importance.push_back(p.x < box.low.x + (box.high.x - box.low.x) / 3 ? 1000.0F : 1.0F);
    const auto result = simplify(mesh, options);
    REQUIRE(result);
    PlacementOptions placement;
    placement.fixed = result->locked;
    const Mesh level = extract_level(result->mesh, Cursor(result->mesh));
    const Mesh fitted = optimise_placement(mesh, level, placement);
    std::set<Place> fixed, before, after;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (result->locked[v] != 0) fixed.insert(place_of(mesh, v));
    const auto fixed_faces = [&](const Mesh& of) {
      std::multiset<std::array<Place, 3>> faces;
      for (Index f = 0; f < of.face_count(); ++f) {
        std::array<Place, 3> face;
        for (Index k = 0; k < 3; ++k) face[k] = place_of(of, of.corner_vertex(3 * f + k));
        std::sort(face.begin(), face.end());
        if (std::all_of(face.begin(), face.end(), [&](const Place& p) { return fixed.contains(p); }))
          faces.insert(face);
      }
      return faces;
    };
    const auto kept = fixed_faces(level), now = fixed_faces(fitted);
    CHECK(std::includes(now.begin(), now.end(), kept.begin(), kept.end()));
    for (Index v = 0; v < level.vertex_count(); ++v) before.insert(place_of(level, v));
    for (Index v = 0; v < fitted.vertex_count(); ++v) after.insert(place_of(fitted, v));
    CHECK(std::includes(after.begin(), after.end(), fixed.begin(), fixed.end()));
    moved += before == after ? 0 : 1;
  }
  CHECK(moved > 1);
}

TEST_CASE("a fitter gives for each level what a fit of its own gives, from several threads, too") {
  const Mesh mesh = mesh_of(torus(48, 32));
  std::vector<Mesh> levels;
  for (const double ratio : {0.5, 0.25, 0.1, 0.05}) levels.push_back(level_of(mesh, ratio));
  const LevelFitter fitter(mesh);
  std::vector<Mesh> fitted(levels.size());
  for_each_in_parallel(levels.size(), [&](std::size_t i) { fitted[i] = fitter.fit(levels[i]); });
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Mesh alone = optimise_placement(mesh, levels[i]);
    CHECK(fitted[i].positions == alone.positions);
    CHECK(fitted[i].corner_wedge == alone.corner_wedge);
  }
}

TEST_CASE("more effort fits better, and the least is better than none") {
  double least = 0, usual = 0, best = 0;
  for (const TriangleSoup& soup : {icosphere(kReduced ? 3 : 4, 0.01, 5), torus(kReduced ? 24 : 48, kReduced ? 16 : 32),
                                   terrain(kReduced ? 24 : 40, 3)}) {
    const Mesh mesh = mesh_of(soup);
    for (const double ratio : {0.19, 0.1}) {
      if (kReduced && ratio > 0.1) continue;
      const Mesh level = level_of(mesh, ratio);
      const double unfitted = rms(mesh, level);
      const auto gain = [&](int effort) {
        PlacementOptions options;
        options.effort = effort;
        return rms(mesh, optimise_placement(mesh, level, options)) / unfitted;
      };
      INFO(mesh.face_count() << " faces at " << ratio);
      const double of_least = gain(kLeastEffort);
      CHECK(of_least < 1);
      least += std::log(of_least);
      usual += std::log(gain(kDefaultEffort));
      best += std::log(gain(kMostEffort));
    }
  }
  CHECK(usual < least - 0.1);
  CHECK(best < usual);
}

TEST_CASE("the least efforts leave fine levels as they are") {
  const Mesh mesh = mesh_of(icosphere(kReduced ? 3 : 4, 0.01, 5));
  for (const auto& [effort, finest] : {std::pair{1, 0.2}, std::pair{2, 0.3}, std::pair{3, 1.0}})
    for (const double ratio : {0.5, 0.25, 0.15}) {
      CAPTURE(effort, ratio);
      const Mesh level = level_of(mesh, ratio);
      PlacementOptions options;
      options.effort = effort;
      const Mesh fitted = optimise_placement(mesh, level, options);
      bool is_same = fitted.face_count() == level.face_count();
      for (Index c = 0; is_same && c < 3 * level.face_count(); ++c)
        is_same = fitted.positions[fitted.corner_vertex(c)] == level.positions[level.corner_vertex(c)];
      CHECK(is_same == (ratio > finest));
    }
}

TEST_CASE("a fit that is cancelled at any call makes no other and leaves the level as it was") {
  const Mesh mesh = mesh_of(icosphere(4, 0.02, 3));
  const Mesh level = level_of(mesh, 0.3);
  bool ends = false;
  for (int last = 1; !ends; last = 2 * last + 1) {
    CAPTURE(last);
    int calls = 0;
    PlacementOptions options;
    options.progress = [&](double) { return ++calls < last; };
    const Mesh fitted = optimise_placement(mesh, level, options);
    CHECK(calls <= last);
    ends = calls < last;
    bool is_same = fitted.face_count() == level.face_count();
    for (Index c = 0; is_same && c < 3 * level.face_count(); ++c)
      is_same = fitted.positions[fitted.corner_vertex(c)] == level.positions[level.corner_vertex(c)];
    CHECK(is_same == !ends);
  }
}

TEST_CASE("the same level is fitted to the same bytes") {
  const Mesh mesh = mesh_of(icosphere(4, 0.02, 3));
  const Mesh level = level_of(mesh, 0.1);
  const Mesh a = optimise_placement(mesh, level);
  const Mesh b = optimise_placement(mesh, level);
  CHECK(a.positions == b.positions);
  CHECK(a.corner_wedge == b.corner_wedge);
}

}  // namespace lodestone::test

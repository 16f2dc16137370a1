// What random removals leave, against every pair of faces, and against the measure that starts afresh.

#include "distance/level_deviation.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <numeric>
#include <span>
#include <vector>

#include "distance/displacement.h"
#include "simplify/pieces.h"
#include "support/data.h"
#include "support/deviations.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/random_removals.h"

namespace lodestone::test {
namespace {

using detail::FaceChange;
using detail::LevelDeviation;

constexpr std::size_t kMostFaces = kReduced ? 60 : 160;  // of what is measured against all pairs of faces

double diagonal_of(const Mesh& mesh) { return bounding_box(mesh).diagonal(); }

/// A mesh from which vertices are removed at random, and sometimes pieces.
class Shrinking {
 public:
  explicit Shrinking(const NamedShape& shape, std::uint64_t seed = 7)
      : mesh_(mesh_of(shape.soup)),
        connectivity_(*Connectivity::build(mesh_)),
        pieces_(mesh_, connectivity_),
        random_(seed) {}

  const Mesh& mesh() const { return mesh_; }
  const Connectivity& connectivity() const { return connectivity_; }

  /// Removes about so many vertices, and tells; false once none can go.
  bool shrink(std::size_t count, std::span<LevelDeviation* const> told) {
    bool any = false;
    for (; count > 0; --count) {
      const RemovalRecord record = remove_any(connectivity_, random_);
      if (record.vertex == kNoIndex) break;
      any = true;
      const FaceChange change = changes_.add(record, detail::displacement_bound(mesh_, record));
      for (LevelDeviation* deviation : told) deviation->add(change);
    }
    return any;
  }

  /// Removes a piece, if that leaves others.
  void vanish(std::span<LevelDeviation* const> told) {
    if (pieces_.left() < 2) return;
    Index piece = 0;
    while (gone_[piece]) ++piece;
    gone_[piece] = true;
    const std::vector<RemovalRecord> records = remove_component(connectivity_, pieces_.vertices(piece));
    pieces_.vanish(piece);
    Index near = 0;
    while (!connectivity_.has_vertex(near)) ++near;
    double reach = 0;
    for (const RemovalRecord& record : records)
      reach = std::max(reach, length(Vec3(mesh_.positions[record.vertex]) - Vec3(mesh_.positions[near])));
    const FaceChange change = changes_.add_vanished(records, face_of_corner(connectivity_.corner_at(near)), reach);
    for (LevelDeviation* deviation : told) deviation->add(change);
  }

  /// What is left; and that as a mesh of all vertices.
  LevelDeviation::Level left() const { return {mesh_, connectivity_}; }
  Mesh level() const {
    std::vector<Index> corners;
    for (Index c = 0; c < mesh_.corner_wedge.size(); ++c)
      if (connectivity_.has_face(face_of_corner(c))) corners.push_back(connectivity_.vertex(c));
    return raw_mesh(mesh_.positions, std::move(corners));
  }

 private:
  Mesh mesh_;
  Connectivity connectivity_;
  detail::Pieces pieces_;
  detail::FaceChanges changes_;
  std::vector<bool> gone_ = std::vector<bool>(pieces_.count());
  Random random_;
};

/// The range of the supremum, from the distances to all faces.
SampledSupremum brute_force(const Mesh& from, const Mesh& to) {
  return sample_supremum(
      from, [&](const Vec3& p) { return distance_to_all(p, to); }, 4);
}

std::vector<NamedShape> shapes_of_at_most(std::size_t face_count) {
  std::vector<NamedShape> few;
  for (NamedShape& shape : all_shapes()) {
    const std::size_t faces = mesh_of(shape.soup).face_count();
    if (faces > 0 && faces <= face_count) few.push_back(std::move(shape));
  }
  return few;
}

}  // namespace

TEST_CASE("a level's faces are beside those that their edges say") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    Shrinking shrinking(shape);
    if (shrinking.mesh().face_count() == 0) continue;
    for (std::size_t step = 1; shrinking.shrink(step, {}); step *= 2) {
      const LevelDeviation::Level level = shrinking.left();
      CHECK(level.opposite == detail::opposite_corners(level.mesh));
    }
  }
}

TEST_CASE("each way, the maximum lies between its bounds as all pairs of faces have it, whatever was removed before") {
  for (const NamedShape& shape : shapes_of_at_most(kMostFaces)) {
    Shrinking shrinking(shape);
    LevelDeviation deviation(shrinking.mesh(), {});
    LevelDeviation* const told[] = {&deviation};
    std::size_t step = 0;
    do {
      const Mesh level = shrinking.level();
      INFO(shape.name << ", level of " << level.face_count() << " faces");
      const SampledSupremum there = brute_force(shrinking.mesh(), level), back = brute_force(level, shrinking.mesh());
      CHECK(deviation.bound() >= std::max(there.low, back.low) * (1 - 1e-9) - 1e-12);
      if (step % 2 == 0) {
        const Deviation found = deviation.measure(shrinking.left());
        check_contains(found.forward, there);
        check_contains(found.backward, back);
        CHECK(found.maximum_bound() <= allowed(found.maximum(), {}, diagonal_of(shrinking.mesh())));
        CHECK(deviation.bound() <= found.maximum_bound());
      }
      if (step % 4 == 1) shrinking.vanish(told);
    } while (shrinking.shrink(++step, told));
  }
}

TEST_CASE("measured again and again, what removals leave is as far away as measured alone") {
  DeviationOptions options;
  options.relative_tolerance = 0.01;
  for (const NamedShape& shape : all_shapes()) {
    Shrinking shrinking(shape);
    if (shrinking.mesh().face_count() == 0) continue;
    const double diagonal = diagonal_of(shrinking.mesh());
    LevelDeviation deviation(shrinking.mesh(), options), often(shrinking.mesh(), options);
    LevelDeviation* const told[] = {&deviation, &often};
    CHECK(deviation.measure(shrinking.left()).maximum_bound() <= allowed(0, {}, diagonal));
    const MeasuredSurface original(shrinking.mesh());
    const std::size_t some = std::max<std::size_t>(shrinking.mesh().vertex_count() / 20, 1);
    for (int i = 0; i < (kReduced ? 6 : 16) && shrinking.shrink(some, told); ++i) {
      often.measure(shrinking.left());
      if (i % 3 == 1) continue;
      const Mesh level = shrinking.level();
      INFO(shape.name << ", level of " << level.face_count() << " faces");
      const Deviation alone = measure_maximum(original, MeasuredSurface(level), options);
      const Deviation found = deviation.measure(shrinking.left());
      const Deviation again = often.measure(shrinking.left());
      for (const Deviation* one : {&found, &again}) {
        CHECK(overlap(*one, alone));
        CHECK(one->maximum_bound() <= allowed(one->maximum(), options, diagonal));
      }
    }
  }
}

TEST_CASE("a spent budget, or a measurement that is cancelled, gives a bound that is wide, but true, then and later") {
  for (const NamedShape& shape : shapes_of_at_most(kMostFaces)) {
    Shrinking shrinking(shape);
    bool is_wanted = true;
    DeviationOptions spent, cancelled;
    spent.budget = 1;
    cancelled.progress = [&](double) { return is_wanted; };
    LevelDeviation narrow(shrinking.mesh(), {}), wide(shrinking.mesh(), spent), ended(shrinking.mesh(), cancelled);
    LevelDeviation* const told[] = {&narrow, &wide, &ended};
    for (int i = 0; shrinking.shrink(3, told); ++i) {
      INFO(shape.name << ", level of " << shrinking.connectivity().face_count() << " faces");
      is_wanted = i % 2 == 0;
      const Deviation exact = narrow.measure(shrinking.left());
      CHECK(overlap(exact, wide.measure(shrinking.left())));
      CHECK(overlap(exact, ended.measure(shrinking.left())));
    }
  }
}

// What is known of a vertex whose face has gone bounds faces that a much later measurement looks at, and has to stay
// true until then. Rough meshes show it, where a few removals move the surface far and most faces are not looked at.
TEST_CASE("bounds stay true over many measurements that leave most faces unlooked at") {
  DeviationOptions close;
  close.relative_tolerance = 0.02;
  for (std::uint64_t seed = 1; seed <= (kReduced ? 6 : 60); ++seed) {
    Shrinking shrinking({"rough", seed % 2 == 0 ? grid(10, 0.05, seed) : terrain(10, seed), true, 1}, seed);
    const MeasuredSurface original(shrinking.mesh());
    std::deque<LevelDeviation> all;
    for (const double tolerance : {0.0, 0.1})
      for (const std::size_t budget : {0, 1000000}) {
        DeviationOptions options;
        options.relative_tolerance = 5 * tolerance;
        options.absolute_tolerance = tolerance * diagonal_of(shrinking.mesh());
        options.budget = budget;
        all.emplace_back(shrinking.mesh(), options);
      }
    std::vector<LevelDeviation*> told;
    for (LevelDeviation& deviation : all) told.push_back(&deviation);
    while (shrinking.shrink(3, told)) {
      const Mesh level = shrinking.level();
      INFO("seed " << seed << ", level of " << level.face_count() << " faces");
      const Deviation alone = measure_maximum(original, MeasuredSurface(level), close);
      for (LevelDeviation& deviation : all) {
        CHECK(alone.maximum() <= deviation.bound() + 1e-12);
        CHECK(alone.maximum() <= deviation.measure(shrinking.left()).maximum_bound() + 1e-12);
      }
    }
  }
}

}  // namespace lodestone::test

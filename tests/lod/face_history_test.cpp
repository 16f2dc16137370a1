// Fates of faces against a search through all that came of each.

#include "distance/face_history.h"

#include <algorithm>
#include <map>
#include <vector>

#include "distance/displacement.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/random_removals.h"

namespace lodestone::test {
namespace {

using detail::FaceHistory;

/// What has come of one face: the faces that its points may be on now, and how far they may have been moved.
struct Descent {
  std::map<Index, double> faces;
  bool is_there = true;

  void follow(const RemovalRecord& record, double displacement) {
    double moved = -1;
    for (const SectorPatch& sector : record.sectors)
      for (const Index face : sector.faces) {
        const auto found = faces.find(face);
        if (found == faces.end()) continue;
        moved = std::max(moved, found->second);
        faces.erase(found);
      }
    if (moved < 0) return;
    is_there = false;
    const auto add = [&](Index face) { faces[face] = std::max(faces[face], moved + displacement); };
    for (const SectorPatch& sector : record.sectors) {
      for (std::size_t i = 0; i < sector.triangles.size(); ++i) add(sector.faces[i]);
      if (sector.lone_outer != kNoIndex) add(face_of_corner(sector.lone_outer));
    }
  }

  double moved() const {
    double most = 0;
    for (const auto& [face, way] : faces) most = std::max(most, way);
    return most;
  }
};

}  // namespace

TEST_CASE("each face is still there, or its points are no farther than moved, on faces that took its place") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0 || mesh.face_count() > (kReduced ? 100 : 1000)) continue;
    Connectivity connectivity = *Connectivity::build(mesh);
    FaceHistory history(mesh.face_count());
    Random random(3);
    std::vector<std::vector<Descent>> descents;  // by period, by face
    for (int period = 0; period < 9; ++period) {
      std::vector<Descent>& begun = descents.emplace_back(mesh.face_count());
      for (Index f = 0; f < begun.size(); ++f)
        if (connectivity.has_face(f)) begun[f].faces[f] = 0;
      for (std::size_t i = 0; i < 1 + mesh.vertex_count() / 20; ++i) {
        const RemovalRecord record = remove_any(connectivity, random);
        if (record.vertex == kNoIndex) break;
        const double displacement = detail::displacement_bound(mesh, record);
        history.now().add(record, displacement);
        for (std::vector<Descent>& since : descents)
          for (Descent& descent : since) descent.follow(record, displacement);
      }
      std::size_t visited = 0;
      Index last = history.period() + 1;
      history.look_back([&](Index since, std::span<const FaceHistory::Fate> fates) {
        REQUIRE(since + 1 == last);
        last = since;
        ++visited;
        for (Index f = 0; f < fates.size(); ++f) {
          const Descent& descent = descents[since][f];
          if (descent.faces.empty()) continue;  // it was not there then
          REQUIRE(fates[f].is_there() == descent.is_there);
          if (descent.is_there) continue;
          CHECK(fates[f].moved >= static_cast<float>(descent.moved()));
          CHECK(static_cast<double>(fates[f].moved) <= descent.moved() * (1 + 1e-4));
          CHECK(descent.faces.count(fates[f].heir) == 1);
        }
      });
      CHECK(visited == static_cast<std::size_t>(std::min(period + 1, 5)));
      history.end_period();
    }
  }
}

}  // namespace lodestone::test

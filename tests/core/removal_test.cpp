#include <lodestone/core/removal.h>

#include <lodestone/core/validate.h>

#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/random_removals.h"

namespace lodestone::test {

TEST_CASE(
    "after every removal the mesh is manifold and keeps its Euler characteristic, and undoing all gives it back") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    auto connectivity = Connectivity::build(mesh);
    REQUIRE(connectivity);
    const int euler = euler_characteristic(*connectivity);
    Random random(42);
    std::vector<Connectivity> before;
    std::vector<RemovalRecord> records;
    for (Index step = 0; step < 4 * mesh.vertex_count() && records.size() < 120; ++step) {
      const auto vertex = static_cast<Index>(random.below(mesh.vertex_count()));
      RemovalRecord record;
      if (!connectivity->has_vertex(vertex) || !plan_removal(*connectivity, vertex, random, record)) continue;
      before.push_back(*connectivity);
      remove_vertex(*connectivity, record);
      records.push_back(record);
      const auto valid = validate(*connectivity);
      INFO((valid ? "" : valid.error().message));
      REQUIRE(valid);
      REQUIRE(euler_characteristic(*connectivity) == euler);
    }
    while (!records.empty()) {
      restore_vertex(*connectivity, records.back());
      REQUIRE(*connectivity == before.back());
      records.pop_back();
      before.pop_back();
    }
  }
}

TEST_CASE("a crease stays a crease across removals") {
  const Mesh mesh = mesh_of(grid(4, 0, 1));
  auto connectivity = Connectivity::build(mesh);
  REQUIRE(connectivity);
  // Mark the middle line x = ½ as a crease: its inner vertices become features.
  std::size_t marked = 0;
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
    const Vec3 a = mesh.corner_position(next_corner(c));
    const Vec3 b = mesh.corner_position(previous_corner(c));
    if (a.x != 0.5 || b.x != 0.5) continue;
    connectivity->mark_crease(c);
    ++marked;
  }
  REQUIRE(marked == 8);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (connectivity->kind(v) != VertexKind::Feature) continue;
    const Connectivity before = *connectivity;
    RemovalRecord record;
    Random random(1);
    if (!plan_removal(*connectivity, v, random, record)) continue;
    CHECK(record.sectors.size() == 2);
    remove_vertex(*connectivity, record);
    CHECK(validate(*connectivity));
    const Index a = connectivity->vertex_of_wedge(record.sectors[0].polygon.front());
    const Index b = connectivity->vertex_of_wedge(record.sectors[0].polygon.back());
    CHECK(connectivity->has_edge(a, b));
    restore_vertex(*connectivity, record);
    CHECK(*connectivity == before);
  }
}

}  // namespace lodestone::test

#include <vector>

#include <lodestone/core/detail/compaction.h>

#include "support/catch.h"

namespace lodestone::test {

using detail::compacted;
using detail::CompactedMesh;
using detail::Compaction;
using detail::in_old_order;
using detail::pick_entries;

TEST_CASE("things are numbered as they are added, each once") {
  Compaction things(6);
  CHECK(things.add(4) == 0);
  CHECK(things.add(1) == 1);
  CHECK(things.add(4) == 0);
  CHECK(things.number(1) == 1);
  CHECK(things.number(5) == kNoIndex);
  CHECK(things.used() == std::vector<Index>{4, 1});
}

TEST_CASE("things that are used may keep their order") {
  const Compaction things = in_old_order(6, std::vector<Index>{4, 1, 4, 2});
  CHECK(things.used() == std::vector<Index>{1, 2, 4});
  CHECK(things.number(4) == 2);
  CHECK(things.number(0) == kNoIndex);
}

TEST_CASE("a mesh of triangles has what they use, in order of first use") {
  const std::vector<Vec3f> positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  const std::vector<Index> wedge_vertex = {0, 1, 1, 3, 4, 4};
  const std::vector<Index> corner_wedge = {5, 2, 3, 3, 1, 4};
  const CompactedMesh result = compacted(positions, wedge_vertex, corner_wedge);
  CHECK(result.mesh.corner_wedge == std::vector<Index>{0, 1, 2, 2, 3, 4});
  CHECK(result.source_wedge == std::vector<Index>{5, 2, 3, 1, 4});
  CHECK(result.source_vertex == std::vector<Index>{4, 1, 3});
  CHECK(result.mesh.wedge_vertex == std::vector<Index>{0, 1, 2, 1, 0});
  CHECK(result.mesh.positions == pick_entries(positions, result.source_vertex));
}

}  // namespace lodestone::test

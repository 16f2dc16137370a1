#include <lodestone/lod/cursor.h>

#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/progressive_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

std::vector<std::vector<Index>> buffers(const ProgressiveMesh& mesh, const Cursor& cursor) {
  std::vector<std::vector<Index>> all;
  for (std::size_t group = 0; group < mesh.groups.size(); ++group)
    all.emplace_back(cursor.corners(group).begin(), cursor.corners(group).end());
  return all;
}

}  // namespace

TEST_CASE("a level does not depend on the way to it") {
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    const auto count = static_cast<Index>(mesh.record_count());
    Cursor walker(mesh);
    Random random(count);
    for (int i = 0; i < 20; ++i) {
      const auto goal = static_cast<Index>(random.below(std::uint64_t{count} + 1));
      walker.seek(goal);
      Cursor direct(mesh);
      direct.seek(goal);
      REQUIRE(walker.position() == goal);
      REQUIRE(buffers(mesh, walker) == buffers(mesh, direct));
    }
  }
}

TEST_CASE("steps are seeks by one, and undo each other") {
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    Cursor cursor(mesh);
    while (cursor.position() < mesh.record_count()) {
      const auto before = buffers(mesh, cursor);
      const Index position = cursor.position();
      cursor.refine();
      REQUIRE(cursor.position() == position + 1);
      cursor.coarsen();
      REQUIRE(buffers(mesh, cursor) == before);
      cursor.refine();
    }
  }
}

TEST_CASE("counts are those of the buffers and of the stream, at every position") {
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    const std::vector<Index> faces = face_counts(mesh);
    Cursor cursor(mesh);
    for (Index position = 0; position <= mesh.record_count(); ++position) {
      cursor.seek(position);
      std::size_t corners = 0;
      for (const std::vector<Index>& group : buffers(mesh, cursor)) {
        corners += group.size();
        for (const Index wedge : group) REQUIRE(wedge < cursor.wedge_count());
      }
      REQUIRE(cursor.face_count() == faces[position]);
      REQUIRE(corners == 3 * std::size_t{faces[position]});
      REQUIRE(cursor.vertex_count() == mesh.base_vertex_count + std::size_t{position});
    }
    CHECK(extract_level(mesh, cursor).face_count() == faces.back());
  }
}

TEST_CASE("seeking stops at the ends, and buffers stay where they are") {
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    Cursor cursor(mesh);
    std::vector<const Index*> places;
    for (std::size_t group = 0; group < mesh.groups.size(); ++group) places.push_back(cursor.corners(group).data());
    cursor.seek(kNoIndex);
    CHECK(cursor.position() == mesh.record_count());
    cursor.seek(0);
    CHECK(cursor.position() == 0);
    for (std::size_t group = 0; group < mesh.groups.size(); ++group)
      CHECK(cursor.corners(group).data() == places[group]);
  }
}

}  // namespace lodestone::test

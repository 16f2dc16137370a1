#include <lodestone/core/removal.h>

#include <lodestone/core/validate.h>

#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

/// Whether filling the polygon as a fan from its corner `apex` keeps the mesh simple.
bool fan_is_simple(const Connectivity& mesh, const SectorPatch& sector, std::size_t apex, Index vertex) {
  const std::size_t size = sector.polygon.size();
  std::set<Index> distinct;
  for (const Index wedge : sector.polygon) distinct.insert(mesh.vertex_of_wedge(wedge));
  if (distinct.size() != size || distinct.count(vertex) != 0) return false;
  for (std::size_t i = 0; i < size; ++i) {
    const bool is_neighbour = i == apex || (i + 1) % size == apex || (apex + 1) % size == i;
    if (!is_neighbour &&
        mesh.has_edge(mesh.vertex_of_wedge(sector.polygon[apex]), mesh.vertex_of_wedge(sector.polygon[i])))
      return false;
  }
  return true;
}

void fill_with_fan(SectorPatch& sector, std::size_t apex) {
  const auto size = sector.polygon.size();
  for (std::size_t i = 1; i + 1 < size; ++i) {
    std::array<std::size_t, 3> c{apex, (apex + i) % size, (apex + i + 1) % size};
    std::sort(c.begin(), c.end());
    sector.triangles.push_back(
        {static_cast<std::uint8_t>(c[0]), static_cast<std::uint8_t>(c[1]), static_cast<std::uint8_t>(c[2])});
  }
}

bool closing_edge_is_free(const Connectivity& mesh, const RemovalRecord& record) {
  const SectorPatch& first = record.sectors.front();
  const auto vertex = [&](const SectorPatch& s, std::size_t i) { return mesh.vertex_of_wedge(s.polygon[i]); };
  if (first.shape == SectorShape::Closed) {
    // A triangle must not be closed over an existing one.
    const Index outer = mesh.opposite(3 * first.faces[0] + first.rotation[0]);
    return first.polygon.size() > 3 || outer == kNoIndex || mesh.vertex(outer) != vertex(first, 2);
  }
  for (const SectorPatch& sector : record.sectors)
    if (sector.polygon.size() == 2) return false;
  return !mesh.has_edge(vertex(first, 0), vertex(first, first.polygon.size() - 1));
}

/// Describes the removal of `vertex` with fans, if it is legal; geometry plays no part here.
bool plan_removal(const Connectivity& mesh, Index vertex, Random& random, RemovalRecord& record) {
  Star star;
  mesh.gather_star(vertex, star);
  const VertexKind kind = mesh.kind(vertex, star);
  if (kind != VertexKind::Interior && kind != VertexKind::Border && kind != VertexKind::Feature) return false;
  if (star.corners.size() > 60) return false;
  record.vertex = vertex;
  describe_removal(mesh, star, record);
  if (!closing_edge_is_free(mesh, record)) return false;
  for (SectorPatch& sector : record.sectors) {
    const auto apex = random.below(sector.polygon.size());
    if (!fan_is_simple(mesh, sector, apex, vertex)) return false;
    fill_with_fan(sector, apex);
  }
  return true;
}

}  // namespace

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

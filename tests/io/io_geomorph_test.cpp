#include <lodestone/io/geomorph.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/lod/surface_index.h>

#include "support/arriving.h"
#include "support/counted_memory.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/placed_shapes.h"
#include "support/progressive_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

using Triangle = std::array<Index, 3>;
using Triangles = std::multiset<Triangle>;
using Pair = std::pair<Index, Index>;

ProgressiveMesh dense(const TriangleSoup& soup) {
  SimplifyOptions options;
  options.dense_rounds = 1.5;
  options.measure_step = 0;
  return std::move(simplify(mesh_of(soup), options).value().mesh);
}

/// Those of all families, as they are and with records that move vertices.
std::vector<ProgressiveMesh> all_meshes() {
  std::vector<ProgressiveMesh> meshes = progressive_shapes();
  const std::size_t count = meshes.size();
  for (std::size_t i = 0; i < count; ++i) {
    meshes.push_back(meshes[i]);
    add_moves(meshes.back(), 0.1, i + 1);
  }
  return meshes;
}

/// All pairs of positions of a small mesh, coarse and fine; some of a larger one, neighbours among them.
std::vector<Pair> pairs_of(const ProgressiveMesh& mesh) {
  const auto last = static_cast<Index>(mesh.record_count());
  std::vector<Pair> pairs;
  if (last <= 24) {
    for (Index fine = 0; fine <= last; ++fine)
      for (Index coarse = 0; coarse <= fine; ++coarse) pairs.emplace_back(coarse, fine);
    return pairs;
  }
  Random random(last);
  for (int i = 0; i < (kReduced ? 20 : 100); ++i) {
    const auto a = static_cast<Index>(random.below(last)), b = static_cast<Index>(random.below(last + 1));
    pairs.push_back(std::minmax(a, b));
    pairs.emplace_back(a, a + 1);
  }
  return pairs;
}

Triangle rotated(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// A level's faces by `name` of their wedges, without those that two corners of are one.
template <class Name>
Triangles triangles(const ProgressiveMesh& mesh, Index position, const Name& name) {
  Triangles all;
  const Mesh level = extract_level(mesh, position);
  for (std::size_t c = 0; c < level.corner_wedge.size(); c += 3) {
    const Index* w = &level.corner_wedge[c];
    const Triangle t = rotated({name(w[0]), name(w[1]), name(w[2])});
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) all.insert(t);
  }
  return all;
}

/// Whether the fine level's faces are the coarse one's at t = 0, by vertices, besides those without area.
bool is_exact(const ProgressiveMesh& mesh, const Geomorph& morph) {
  const auto own = [&](Index wedge) { return mesh.wedge_vertex[wedge]; };
  return triangles(mesh, morph.coarse(), own) ==
         triangles(mesh, morph.fine(), [&](Index wedge) { return own(morph.origin(wedge)); });
}

/// The fine level as it is at t.
Mesh level_at(const ProgressiveMesh& mesh, const Geomorph& morph, double t) {
  Mesh level = extract_level(mesh, morph.fine());
  for (Index w = 0; w < level.wedge_vertex.size(); ++w) {
    Vec3f& place = level.positions[level.wedge_vertex[w]];
    if (w > 0 && level.wedge_vertex[w] == level.wedge_vertex[w - 1]) continue;
    place = to_float(Vec3(morph.start(w)) * (1 - t) + Vec3(place) * t);
  }
  return level;
}

/// Samples of faces with area: their middles and those of their edges.
template <class Visit>
void visit_samples(const Mesh& mesh, const Visit& visit) {
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const double area = length(area_vector(mesh, f)) / 2;
    if (area < 1e-12) continue;
    const Vec3 a = mesh.corner_position(3 * f), b = mesh.corner_position(3 * f + 1),
               c = mesh.corner_position(3 * f + 2);
    for (const Vec3& p : {(a + b + c) * (1.0 / 3), (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5}) visit(p, area / 4);
  }
}

bool has_faces_everywhere(const Mesh& mesh) {
  std::vector<bool> used(mesh.vertex_count(), false);
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) used[mesh.corner_vertex(c)] = true;
  return std::find(used.begin(), used.end(), false) == used.end();
}

struct Apart {
  double mean = 0, most = 0;
};

Apart distance_to(const SurfaceIndex& surface, const Mesh& mesh) {
  Apart apart;
  double all = 0;
  visit_samples(mesh, [&](const Vec3& p, double area) {
    const double distance = surface.nearest(p, HUGE_VAL).distance;
    apart.most = std::max(apart.most, distance);
    apart.mean += area * distance;
    all += area;
  });
  if (all > 0) apart.mean /= all;
  return apart;
}

/// What an engine has, which writes only what is named: where wedges are, and where they begin.
struct Engine {
  std::vector<float> starts, ends;
  std::vector<EntryRange> ranges;

  /// Takes what a cursor names.
  void upload(const ProgressiveMesh& mesh, DrawCursor& cursor) {
    const EntryRange wedges = cursor.take_new_wedges();
    ends.resize(3 * wedges.end);
    cursor.take_moved_wedges(64, ranges);
    ranges.push_back(wedges);
    for (const EntryRange& range : ranges) copy_positions(mesh, cursor, range, ends.data() + 3 * range.begin);
  }

  /// Has the two differ where a morph says so.
  void begin(Geomorph& morph) {
    starts = ends;
    morph.take_moved_wedges(64, ranges);
    ranges.push_back(morph.new_wedges());
    for (const EntryRange& range : ranges) copy_starts(morph, range, starts.data() + 3 * range.begin);
  }
};

void check_positions(const ProgressiveMesh& mesh, const std::vector<float>& positions,
                     const std::vector<Vec3f>& expected, std::size_t wedges) {
  for (std::size_t w = 0; w < wedges; ++w)
    REQUIRE(Vec3f{positions[3 * w], positions[3 * w + 1], positions[3 * w + 2]} == expected[mesh.wedge_vertex[w]]);
}

}  // namespace

TEST_CASE("faces begin with vertices of the coarse level, and all wedges of a vertex in one place") {
  for (const ProgressiveMesh& mesh : all_meshes()) {
    Geomorph morph(mesh);
    for (const auto& [coarse, fine] : pairs_of(mesh)) {
      morph.set(coarse, fine);
      REQUIRE(morph.coarse() == coarse);
      REQUIRE(morph.fine() == fine);
      const std::vector<Vec3f> before = positions_at(mesh, coarse);
      const Mesh level = extract_level(mesh, fine);
      const EntryRange added = morph.new_wedges();
      REQUIRE(added == EntryRange{mesh.record_wedge_begin[coarse], level.wedge_count()});
      std::vector<std::optional<Vec3f>> starts(level.vertex_count());
      for (Index w = 0; w < level.wedge_count(); ++w) {
        const Index origin = morph.origin(w);
        if (w < added.begin) {
          REQUIRE(origin == w);
          REQUIRE(morph.start(w) == before[mesh.wedge_vertex[w]]);
        } else if (origin < added.begin) {
          REQUIRE(morph.start(w) == before[mesh.wedge_vertex[origin]]);
        }
        std::optional<Vec3f>& start = starts[mesh.wedge_vertex[w]];
        REQUIRE((!start || *start == morph.start(w)));
        start = morph.start(w);
      }
      // Of a piece that comes into being nothing is seen, as long as no vertex of it is there before.
      if (!has_faces_everywhere(extract_level(mesh, coarse))) continue;
      for (std::size_t c = 0; c < level.corner_wedge.size(); c += 3) {
        const Index* w = &level.corner_wedge[c];
        if (std::all_of(w, w + 3, [&](Index wedge) { return morph.origin(wedge) < added.begin; })) continue;
        REQUIRE((morph.start(w[0]) == morph.start(w[1]) || morph.start(w[1]) == morph.start(w[2]) ||
                 morph.start(w[2]) == morph.start(w[0])));
      }
    }
  }
}

TEST_CASE("where the triangles of every patch meet in a corner the faces begin as the coarse level's") {
  std::size_t exact_steps = 0, steps = 0, exact_ways = 0;
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    Geomorph morph(mesh);
    std::vector<Index> inexact_before(1, 0);  // by position: steps to it that are not exact
    for (Index record = 0; record < mesh.record_count(); ++record) {
      morph.set(record, record + 1);
      const bool exact = is_exact(mesh, morph);
      inexact_before.push_back(inexact_before.back() + (exact ? 0 : 1));
      ++steps;
      exact_steps += exact ? 1 : 0;
      const SectorHeader& sector = mesh.sectors[mesh.sector_begin[record]];
      const bool is_alone = mesh.sector_begin[record + 1] == mesh.sector_begin[record] + 1;
      if (!is_alone || sector.shape != SectorShape::Closed || sector.polygon_size > 5) continue;
      REQUIRE(exact);
      // Wedges are the right ones, too.
      REQUIRE(triangles(mesh, record, [](Index w) { return w; }) ==
              triangles(mesh, record + 1, [&](Index w) { return morph.origin(w); }));
    }
    for (const auto& [coarse, fine] : pairs_of(mesh)) {
      if (inexact_before[fine] != inexact_before[coarse]) continue;
      morph.set(coarse, fine);
      REQUIRE(is_exact(mesh, morph));
      ++exact_ways;
    }
  }
  CHECK(exact_steps > steps / 2);
  CHECK(exact_ways > 1000);
}

TEST_CASE("at t = 0 a flat surface is flat and where it was, and at t = 1 the fine level") {
  for (const TriangleSoup& soup : {grid(8, 0, 1), grid(5, 0, 2), morph_grid(8)}) {
    const ProgressiveMesh mesh = dense(soup);
    Geomorph morph(mesh);
    for (const auto& [coarse, fine] : pairs_of(mesh)) {
      morph.set(coarse, fine);
      const Mesh before = extract_level(mesh, coarse);
      if (before.face_count() == 0) continue;
      CHECK(distance_to(SurfaceIndex(before), level_at(mesh, morph, 0)).most < 1e-6);
    }
  }
}

TEST_CASE("faces begin where the coarse level is, much closer than where they would be without a morph") {
  for (const TriangleSoup& soup : {icosphere(4, 0.02, 1), terrain(40, 3), torus(24, 16), seam_sphere(40, 24)}) {
    const ProgressiveMesh mesh = dense(soup);
    const auto last = static_cast<Index>(mesh.record_count());
    Geomorph morph(mesh);
    for (const Index fine : {last, last / 2, last / 4}) {
      morph.set(fine / 2, fine);
      const Mesh level = extract_level(mesh, fine), before = extract_level(mesh, fine / 2);
      const SurfaceIndex surface(before);
      const Apart begins = distance_to(surface, level_at(mesh, morph, 0)), popped = distance_to(surface, level);
      INFO(begins.mean << " and " << begins.most << ", without " << popped.mean << " and " << popped.most);
      CHECK(begins.mean < 0.6 * popped.mean);
      CHECK(begins.most < 2.5 * popped.most);
      // Halfway it is between the two.
      CHECK(distance_to(surface, level_at(mesh, morph, 0.5)).mean < popped.mean);
    }
  }
}

TEST_CASE("who writes what is named has both ends of the way, there and back") {
  Random random(5);
  for (const ProgressiveMesh& mesh : all_meshes()) {
    DrawCursor cursor(mesh);
    Geomorph morph(mesh);
    Engine engine;
    engine.upload(mesh, cursor);
    for (int i = 0; i < 12; ++i) {
      const Index from = cursor.position(), to = static_cast<Index>(random.below(mesh.record_count() + 1));
      if (to > from) cursor.seek(to);
      engine.upload(mesh, cursor);
      morph.set(std::min(from, to), std::max(from, to));
      engine.begin(morph);
      Geomorph direct(mesh);
      direct.set(morph.coarse(), morph.fine());
      for (Index w = 0; w < cursor.wedge_count(); ++w) {
        REQUIRE(morph.origin(w) == direct.origin(w));
        const Vec3f& start = direct.start(w);
        REQUIRE(Vec3f{engine.starts[3 * w], engine.starts[3 * w + 1], engine.starts[3 * w + 2]} == start);
      }
      check_positions(mesh, engine.ends, positions_at(mesh, morph.fine()), cursor.wedge_count());
      cursor.seek(to);
    }
  }
}

TEST_CASE("attributes begin with those of the origin, whatever their type") {
  for (const TriangleSoup& soup : {seam_cube(6), skinned_cylinder(10, 6), faceted_sphere(2)}) {
    const ProgressiveMesh mesh = dense(soup);
    const auto last = static_cast<Index>(mesh.record_count());
    Geomorph morph(mesh);
    morph.set(last / 3, last);
    const EntryRange wedges = {morph.new_wedges().begin / 2, morph.new_wedges().end};
    for (const Attribute& attribute : mesh.attributes) {
      const std::size_t each = attribute.element_bytes();
      std::vector<std::byte> starts(each * wedges.size());
      copy_starts(morph, attribute, wedges, starts.data());
      for (std::size_t w = wedges.begin; w < wedges.end; ++w)
        REQUIRE(std::memcmp(&starts[each * (w - wedges.begin)],
                            &attribute.data[each * morph.origin(static_cast<Index>(w))], each) == 0);
    }
  }
}

TEST_CASE("normals on either side of a seam begin with those of their side") {
  const ProgressiveMesh mesh = dense(seam_cube(6));
  const auto last = static_cast<Index>(mesh.record_count());
  const auto normal = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                   [](const Attribute& a) { return a.name == "NORMAL"; });
  REQUIRE(normal != mesh.attributes.end());
  const std::size_t each = normal->element_bytes();
  Geomorph morph(mesh);
  std::size_t coarser = 0;
  // As long as the cube has all its corners.
  for (Index coarse = last; coarse-- > 0 && mesh.deviation[coarse] < 1e-6F; ++coarser) {
    morph.set(coarse, last);
    for (std::size_t w = morph.new_wedges().begin; w < morph.new_wedges().end; ++w)
      REQUIRE(std::memcmp(&normal->data[each * w], &normal->data[each * morph.origin(static_cast<Index>(w))], each) ==
              0);
  }
  CHECK(10 * coarser > 9 * std::size_t{last});
}

TEST_CASE("a morph follows a stream that arrives, and allocates nothing where that has not grown") {
  const ProgressiveMesh mesh = dense(terrain(60, 3));
  const auto stream = encode_compact(mesh, {}, scattered_levels(mesh, 2, 0.01, 0.01, 1));
  REQUIRE(stream);
  StreamReader reader;
  Random random(4);
  std::optional<Geomorph> morph;
  arrive(stream->bytes, 4000, random, reader, [&] {
    if (!morph) morph.emplace(reader.mesh());
    const auto last = static_cast<Index>(reader.mesh().record_count());
    const auto coarse = static_cast<Index>(random.below(last + 1));
    morph->set(coarse, kNoIndex);
    REQUIRE(morph->fine() == last);
    Geomorph direct(reader.mesh());
    direct.set(coarse, last);
    for (Index w = 0; w < morph->new_wedges().end; ++w) {
      REQUIRE(morph->origin(w) == direct.origin(w));
      REQUIRE(morph->start(w) == direct.start(w));
    }
  });
  REQUIRE(reader.done());
  CHECK(!reader.mesh().moves.empty());
  const std::size_t allocations = allocation_count;
  const Index last = morph->fine();
  for (const auto& [coarse, fine] : {Pair{0, last}, Pair{last / 2, last}, Pair{last, last}, Pair{last / 3, last / 2}})
    morph->set(coarse, fine);
  CHECK(allocation_count == allocations);
}

}  // namespace lodestone::test

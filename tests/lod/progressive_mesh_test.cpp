#include <lodestone/lod/progressive_mesh.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/placed_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

struct NamedStream {
  std::string name;
  ProgressiveMesh mesh;
};

/// The streams of all families that have faces, down to a few faces and down to none.
std::vector<NamedStream> streams(const std::vector<NamedShape>& shapes = all_shapes()) {
  std::vector<NamedStream> all;
  SimplifyOptions options;
  options.measure_step = 0;
  for (const NamedShape& shape : shapes)
    for (const bool vanish : {false, true}) {
      const Mesh mesh = mesh_of(shape.soup);
      options.vanish = vanish;
      if (mesh.face_count() > 0)
        all.push_back({shape.name + (vanish ? ", to nothing" : ""), simplify(mesh, options).value().mesh});
    }
  return all;
}

using Face = std::array<Index, 3>;

/// A face as it is stored: the largest wedge first.
Face canonical(Face face) {
  std::rotate(face.begin(), std::max_element(face.begin(), face.end()), face.end());
  return face;
}

/// The index buffers of a level, refined by what the comments of ProgressiveMesh say and nothing else.
class LevelByHand {
 public:
  explicit LevelByHand(const ProgressiveMesh& mesh) : mesh_(mesh) {
    for (const FaceGroup& group : mesh.groups) {
      groups_.emplace_back();
      for (std::size_t c = 0; c < group.base_corners.size(); c += 3)
        groups_.back().push_back({group.base_corners[c], group.base_corners[c + 1], group.base_corners[c + 2]});
    }
  }

  const std::vector<std::vector<Face>>& groups() const { return groups_; }

  void refine(Index record) {
    for (Index s = mesh_.sector_begin[record]; s < mesh_.sector_begin[record + 1]; ++s) {
      check_coarse_faces(s);
      place_fine_faces(record, s);
    }
  }

 private:
  Index corner(Index sector, std::size_t i) const { return mesh_.polygons[mesh_.polygon_begin[sector] + i]; }

  void check_coarse_faces(Index s) {
    const SectorHeader& sector = mesh_.sectors[s];
    for (std::size_t i = 0; i + 2 < sector.polygon_size; ++i) {
      const std::uint64_t slot = mesh_.slot_begin(s) + i;
      const std::uint8_t* triangle = &mesh_.triangles[3 * slot];
      const Face face = {corner(s, triangle[0]), corner(s, triangle[1]), corner(s, triangle[2])};
      REQUIRE(groups_[sector.group].at(mesh_.slots[slot]) == canonical(face));
    }
  }

  void place_fine_faces(Index record, Index s) {
    const SectorHeader& sector = mesh_.sectors[s];
    const std::size_t m = sector.polygon_size;
    const std::size_t fine_faces = m - 2 + static_cast<std::size_t>(appended_face_count(sector.shape));
    const Index centre = mesh_.record_wedge_begin[record] + sector.wedge;
    for (std::size_t i = 0; i < fine_faces; ++i) {
      const Face face = canonical({centre, corner(s, i), corner(s, (i + 1) % m)});
      if (i + 2 < m)
        groups_[sector.group].at(mesh_.slots[mesh_.slot_begin(s) + i]) = face;
      else
        groups_[sector.group].push_back(face);
    }
  }

  const ProgressiveMesh& mesh_;
  std::vector<std::vector<Face>> groups_;
};

std::vector<std::vector<Face>> faces_at(const ProgressiveMesh& mesh, const Cursor& cursor) {
  std::vector<std::vector<Face>> groups;
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    groups.emplace_back();
    const auto corners = cursor.corners(g);
    for (std::size_t c = 0; c < corners.size(); c += 3)
      groups.back().push_back({corners[c], corners[c + 1], corners[c + 2]});
  }
  return groups;
}

/// Whether every edge has its reverse as often: the surface has no border.
bool is_closed(const ProgressiveMesh& mesh, const Cursor& cursor) {
  std::map<std::pair<Index, Index>, int> balance;
  for (const auto& group : faces_at(mesh, cursor))
    for (const Face& face : group)
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = mesh.wedge_vertex[face[i]], b = mesh.wedge_vertex[face[(i + 1) % 3]];
        balance[std::minmax(a, b)] += a < b ? 1 : -1;
      }
  return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

/// Whether a record makes a vertex and no face.
bool makes_no_face(const ProgressiveMesh& mesh, Index record) {
  return mesh.sector_begin[record] == mesh.sector_begin[record + 1];
}

std::string message_of(const ProgressiveMesh& mesh) {
  const auto valid = validate(mesh);
  return valid ? "valid" : valid.error().message;
}

/// Goes through all positions and looks at every number a cursor gives; a sanitizer sees what is out of bounds.
void walk(const ProgressiveMesh& mesh) {
  Cursor cursor(mesh);
  const auto base = faces_at(mesh, cursor);
  const auto look = [&] {
    std::size_t faces = 0, outside = 0;
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
      for (const Index wedge : cursor.corners(g)) outside += wedge < cursor.wedge_count() ? 0 : 1;
      faces += cursor.corners(g).size() / 3;
    }
    for (std::size_t w = 0; w < cursor.wedge_count(); ++w)
      outside += mesh.wedge_vertex[w] < cursor.vertex_count() ? 0 : 1;
    REQUIRE(outside == 0);
    REQUIRE(faces == cursor.face_count());
  };
  for (look(); cursor.position() < mesh.record_count(); look()) cursor.refine();
  for (; cursor.position() > 0; look()) cursor.coarsen();
  REQUIRE(faces_at(mesh, cursor) == base);
}

template <class T>
void spoil_entry(std::vector<T>& values, Random& random) {
  if (values.empty()) return;
  T& value = values[random.below(values.size())];
  const std::uint64_t kind = random.below(4);
  if constexpr (std::is_floating_point_v<T>)
    value = kind == 0 ? -1 : kind == 1 ? std::numeric_limits<T>::quiet_NaN() : value + 1;
  else
    value = kind == 0   ? static_cast<T>(value + 1)
            : kind == 1 ? static_cast<T>(value - 1)
            : kind == 2 ? static_cast<T>(random.next())
                        : values[random.below(values.size())];
}

template <class T>
void spoil_length(std::vector<T>& values, Random& random) {
  if (values.empty() || random.below(2) == 0)
    values.emplace_back();
  else
    values.pop_back();
}

/// Changes one number or one length anywhere.
void spoil(ProgressiveMesh& mesh, Random& random) {
  const auto in = [&](auto& values) {
    if (random.below(4) == 0) return spoil_length(values, random);
    spoil_entry(values, random);
  };
  SectorHeader* sector = mesh.sectors.empty() ? nullptr : &mesh.sectors[random.below(mesh.sectors.size())];
  FaceGroup& group = mesh.groups[random.below(mesh.groups.size())];
  switch (random.below(18)) {
    case 0:
      return in(mesh.wedge_vertex);
    case 1:
      return in(group.base_corners);
    case 2:
      group.face_count += random.below(2) == 0 ? 1 : ~0u;
      return;
    case 3:
      mesh.base_vertex_count += random.below(2) == 0 ? 1 : ~0u;
      return;
    case 4:
      mesh.base_wedge_count += random.below(2) == 0 ? 1 : ~0u;
      return;
    case 5:
      return in(mesh.record_wedge_begin);
    case 6:
      return in(mesh.sector_begin);
    case 7:
      return in(mesh.polygon_begin);
    case 8:
      return in(mesh.polygons);
    case 9:
      return in(mesh.slots);
    case 10:
      return in(mesh.triangles);
    case 11:
      return in(mesh.round_begin);
    case 12:
      return in(mesh.deviation);
    case 13:
      return in(mesh.curvature_error);
    case 14:
      return spoil_length(mesh.positions, random);
    case 15:
      if (sector != nullptr) sector->shape = static_cast<SectorShape>(random.below(6));
      return;
    case 16:
      if (sector != nullptr) sector->polygon_size = static_cast<std::uint16_t>(random.below(7));
      return;
    default:
      if (sector != nullptr) (random.below(2) == 0 ? sector->group : sector->wedge) ^= 1;
      return;
  }
}

}  // namespace

TEST_CASE("a record means what its comment says: coarse faces are there, fine ones take their slots, the rest follow") {
  for (const auto& [name, mesh] : streams()) {
    INFO(name);
    LevelByHand level(mesh);
    Cursor cursor(mesh);
    REQUIRE(level.groups() == faces_at(mesh, cursor));
    for (Index record = 0; record < mesh.record_count(); ++record) {
      level.refine(record);
      cursor.refine();
      REQUIRE(level.groups() == faces_at(mesh, cursor));
    }
    for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
      CHECK(mesh.groups[g].face_count == level.groups()[g].size());
      for (const Face& face : level.groups()[g]) REQUIRE(face == canonical(face));
    }
  }
}

TEST_CASE("arrays have the lengths and the order that their comments promise") {
  for (const auto& [name, mesh] : streams()) {
    INFO(name);
    const std::size_t records = mesh.record_count();
    REQUIRE(validate(mesh));
    CHECK(mesh.vertex_count() == mesh.base_vertex_count + records);
    CHECK(std::is_sorted(mesh.wedge_vertex.begin(), mesh.wedge_vertex.end()));
    REQUIRE(mesh.record_wedge_begin.size() == records + 1);
    CHECK(mesh.record_wedge_begin.front() == mesh.base_wedge_count);
    CHECK(mesh.record_wedge_begin.back() == mesh.wedge_vertex.size());
    std::uint64_t slots = 0;
    for (Index k = 0; k < records; ++k) {
      for (Index w = mesh.record_wedge_begin[k]; w < mesh.record_wedge_begin[k + 1]; ++w)
        REQUIRE(mesh.wedge_vertex[w] == mesh.base_vertex_count + k);
      for (Index s = mesh.sector_begin[k]; s < mesh.sector_begin[k + 1]; ++s) {
        const SectorHeader& sector = mesh.sectors[s];
        const bool small = sector.shape == SectorShape::Open || sector.shape == SectorShape::Lone;
        REQUIRE(sector.polygon_size >= (small ? 2 : 3));
        if (sector.shape == SectorShape::Lone) REQUIRE(sector.polygon_size == 2);
        REQUIRE(mesh.slot_begin(s) == slots);
        slots += sector.polygon_size - 2u;
      }
    }
    CHECK(mesh.slots.size() == slots);
    CHECK(mesh.triangles.size() == 3 * slots);
    CHECK(mesh.round_begin.front() == 0);
    CHECK(mesh.round_begin.back() == records);
    REQUIRE(mesh.deviation.size() == records + 1);
    REQUIRE(mesh.curvature_error.size() == records + 1);
    CHECK(mesh.deviation.back() == 0);
    CHECK(mesh.curvature_error.back() == 0);
  }
}

TEST_CASE("faces never get fewer, and end at those of the groups") {
  for (const auto& [name, mesh] : streams()) {
    INFO(name);
    const std::vector<Index> counts = face_counts(mesh);
    REQUIRE(counts.size() == mesh.record_count() + 1);
    CHECK(std::is_sorted(counts.begin(), counts.end()));
    Index base = 0, full = 0;
    for (const FaceGroup& group : mesh.groups) {
      base += static_cast<Index>(group.base_corners.size() / 3);
      full += group.face_count;
    }
    CHECK(counts.front() == base);
    CHECK(counts.back() == full);
  }
  CHECK(face_counts(ProgressiveMesh{}) == std::vector<Index>{0});
}

TEST_CASE(
    "where pieces come into being, a closed surface is open between the positions that are whole, and only there") {
  std::size_t partial = 0;
  for (const auto& [name, mesh] : streams(manifold_shapes())) {
    Cursor cursor(mesh);
    cursor.seek(static_cast<Index>(mesh.record_count()));
    if (!is_closed(mesh, cursor)) continue;
    INFO(name);
    for (Index position = 0; position <= mesh.record_count(); ++position) {
      cursor.seek(position);
      INFO("position " << position);
      REQUIRE(is_whole(mesh, position) == is_closed(mesh, cursor));
      partial += is_whole(mesh, position) ? 0 : 1;
    }
  }
  CHECK(partial > 10);
}

TEST_CASE("a number of faces leads to the finest whole position that has no more, without vertices yet to be used") {
  for (const auto& [name, mesh] : streams()) {
    INFO(name);
    const std::vector<Index> counts = face_counts(mesh);
    for (Index faces = 0; faces <= counts.back() + 1; ++faces) {
      Index expected = 0;
      for (Index p = 0; p < counts.size(); ++p)
        if (counts[p] <= faces && is_whole(mesh, p)) expected = p;
      while (expected > 0 && makes_no_face(mesh, expected - 1)) --expected;
      REQUIRE(position_for_faces(mesh, faces) == expected);
    }
    CHECK(position_for_faces(mesh, std::uint64_t{1} << 40) == position_for_faces(mesh, counts.back()));
  }
}

TEST_CASE("an error leads to the coarsest position within it, to the finest where none is") {
  for (const auto& [name, mesh] : streams()) {
    INFO(name);
    const auto check = [&mesh = mesh](const std::vector<float>& errors, auto position_for) {
      const auto at_worst = static_cast<Index>(mesh.record_count());
      std::vector<double> limits = {-1, 0, 1e-6, 1e9};
      for (const float e : errors)
        limits.insert(limits.end(), {static_cast<double>(e), static_cast<double>(e) * 0.999});
      for (const double limit : limits) {
        const Index found = position_for(mesh, limit);
        const auto is_within = [&](Index p) { return static_cast<double>(errors[p]) <= limit; };
        REQUIRE((is_within(found) || found == at_worst));
        for (Index coarser = 0; coarser < found; ++coarser)
          if (is_within(coarser)) FAIL("position " << coarser << " is within " << limit);
      }
    };
    check(mesh.deviation, position_for_deviation);
    check(mesh.curvature_error, position_for_curvature_error);
  }
  CHECK(position_for_deviation(ProgressiveMesh{}, 1) == 0);
}

TEST_CASE("a mesh with one number changed anywhere is refused, or a cursor stays in bounds and comes back") {
  std::size_t refused = 0, accepted = 0;
  for (const auto& [name, mesh] : streams()) {
    if (mesh.record_count() > 150) continue;
    INFO(name);
    Random random(mesh.record_count());
    for (int i = 0; i < (kReduced ? 60 : 200); ++i) {
      ProgressiveMesh spoilt = mesh;
      spoil(spoilt, random);
      if (const auto valid = validate(spoilt)) {
        walk(spoilt);
        ++accepted;
      } else {
        REQUIRE(valid.error().code == ErrorCode::Malformed);
        REQUIRE_FALSE(valid.error().message.empty());
        ++refused;
      }
    }
  }
  CHECK(refused > 5 * accepted / 2);
  CHECK(accepted > 50);
}

TEST_CASE("what is wrong is named, with the record and the number at fault") {
  const ProgressiveMesh good = simplify(mesh_of(seam_cube(3))).value().mesh;
  const auto message = [&](auto&& change) {
    ProgressiveMesh mesh = good;
    change(mesh);
    return message_of(mesh);
  };
  const std::string record = "record " + std::to_string(good.record_count() - 1);
  CHECK(message([](ProgressiveMesh&) {}) == "valid");

  // Lengths.
  CHECK(message_of(ProgressiveMesh{}) == "record arrays are empty");
  CHECK_THAT(message([](ProgressiveMesh& m) { m.polygon_begin.push_back(0); }), contains("polygon_begin has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.record_wedge_begin.pop_back(); }), contains("record_wedge_begin has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.deviation.pop_back(); }), contains("deviation has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.curvature_error.push_back(0); }), contains("curvature_error has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.positions.pop_back(); }), contains("positions has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.slots.pop_back(); }), contains("slots has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.triangles.pop_back(); }), contains("triangles has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.attributes[0].data.pop_back(); }), contains("attribute NORMAL has "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.attributes[0].component_count = 0; }), contains("attribute NORMAL"));
  CHECK(message([](ProgressiveMesh& m) { m.groups.clear(); }) == "mesh has no face group");
  CHECK(message([](ProgressiveMesh& m) { m.groups[0].base_corners.pop_back(); }) ==
        "group 0 has an incomplete base face");

  // Offsets.
  CHECK_THAT(message([](ProgressiveMesh& m) { m.sector_begin[1] = m.sector_begin[2] + 1; }),
             contains("sector_begin does not rise from 0 to "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.polygon_begin[0] = 1; }),
             contains("polygon_begin does not rise from 0"));
  CHECK_THAT(message([](ProgressiveMesh& m) { ++m.base_wedge_count; }), contains("record_wedge_begin does not rise"));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.round_begin.back() += 1; }), contains("round_begin does not rise"));
  CHECK(message([](ProgressiveMesh& m) {
          m.polygons.clear();
          m.polygon_begin.assign(m.polygon_begin.size(), 0);
        }) == "sectors have polygons of fewer than 2 corners");

  // Values.
  CHECK(message([](ProgressiveMesh& m) { m.positions[3].y = std::nanf(""); }) ==
        "vertex 3 has a position that is not finite");
  for (const float e : {-1.0F, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    CHECK(message([&](ProgressiveMesh& m) { m.deviation[2] = e; }) ==
          "position 2 has an error that is negative or not finite");
    CHECK(message([&](ProgressiveMesh& m) { m.curvature_error[2] = e; }) ==
          "position 2 has an error that is negative or not finite");
  }
  CHECK(message([](ProgressiveMesh& m) { m.wedge_vertex[0] = 999; }) ==
        "wedge 0 of the base mesh names vertex 999 of " + std::to_string(good.base_vertex_count));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.wedge_vertex.back() = 0; }), contains(record + " names vertex 0"));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.groups[0].base_corners[0] = 999; }),
             contains("group 0 of the base mesh names wedge 999 of "));

  // Moves.
  const auto moved = [&](auto&& change) {
    return message([&](ProgressiveMesh& m) {
      add_moves(m, 0.1, 1);
      change(m);
    });
  };
  CHECK(moved([](ProgressiveMesh&) {}) == "valid");
  CHECK(moved([](ProgressiveMesh& m) { m.move_begin.clear(); }).starts_with("moves has "));
  CHECK(moved([](ProgressiveMesh& m) { m.move_begin.pop_back(); }).starts_with("move_begin has "));
  CHECK(moved([](ProgressiveMesh& m) { m.move_begin.back() += 1; }).starts_with("move_begin does not rise from 0 to "));
  CHECK_THAT(moved([](ProgressiveMesh& m) { m.moves.back().vertex = 100000; }),
             contains(" moves vertex 100000 before it exists"));
  CHECK_THAT(moved([](ProgressiveMesh& m) { m.moves.back().from.x += 1; }), contains("from where it does not lie"));
  CHECK_THAT(moved([](ProgressiveMesh& m) { m.moves.back().to.z = std::nanf(""); }), contains("to nowhere"));

  // Records.
  CHECK_THAT(message([](ProgressiveMesh& m) { m.sectors.back().polygon_size += 1; }),
             contains(record + " has a polygon of "));
  CHECK_THAT(message([](ProgressiveMesh& m) { m.sectors[0].shape = static_cast<SectorShape>(7); }),
             contains("record 0 has a polygon of "));
  CHECK(message([](ProgressiveMesh& m) { m.sectors[0].group = 9; }) == "record 0 names group 9");
  CHECK(message([](ProgressiveMesh& m) { m.sectors[0].wedge = 9; }) == "record 0 names its wedge 9");
  CHECK(message([](ProgressiveMesh& m) { m.polygons[0] = 100000; }) == "record 0 names wedge 100000 before it exists");
  const std::string own_wedge = std::to_string(good.base_wedge_count);
  CHECK(message([](ProgressiveMesh& m) { m.polygons[0] = m.base_wedge_count; }) ==
        "record 0 names wedge " + own_wedge + " before it exists");
  const std::string first_new_face = std::to_string(face_counts(good).front());
  CHECK(message([](ProgressiveMesh& m) { m.slots[0] = face_counts(m).front(); }) ==
        "record 0 names face " + first_new_face + " of " + first_new_face);
  CHECK(message([](ProgressiveMesh& m) { m.triangles[1] = m.triangles[0]; }) ==
        "record 0 has a triangle outside its polygon");
  CHECK_THAT(message([](ProgressiveMesh& m) { m.slots[0] = 100000; }), contains("record 0 names face 100000 of "));
  CHECK(message([](ProgressiveMesh& m) { m.triangles[2] = 200; }) == "record 0 has a triangle outside its polygon");
  CHECK_THAT(message([](ProgressiveMesh& m) { std::swap(m.polygons[0], m.polygons[1]); }),
             contains("record 0 does not fit face "));
  CHECK(message([](ProgressiveMesh& m) { m.groups[0].face_count += 1; }) ==
        "group 0 ends with 108 faces where 109 are due");
}

}  // namespace lodestone::test

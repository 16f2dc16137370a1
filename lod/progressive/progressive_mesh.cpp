#include <lodestone/lod/progressive_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <lodestone/core/detail/finite.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/lod/cursor.h>

#include "progressive/canonical_face.h"

namespace lodestone {
namespace {

using detail::is_finite;
using detail::text;

auto defect(const std::string& message) { return fail(ErrorCode::Malformed, message); }

std::string numbered(const char* thing, std::size_t i) { return text(thing, " ", i); }

Index appended_faces(const SectorHeader& sector) { return static_cast<Index>(appended_face_count(sector.shape)); }

bool is_polygon_size(SectorShape shape, std::uint64_t size) {
  switch (shape) {
    case SectorShape::Open:
      return size >= 2;
    case SectorShape::Closed:
    case SectorShape::Moved:
      return size >= 3;
    case SectorShape::Lone:
      return size == 2;
  }
  return false;
}

bool is_error(float value) { return std::isfinite(value) && value >= 0; }

/// Whether a record adds faces to a piece that is coming into being.
bool adds_lone_faces(const ProgressiveMesh& mesh, Index record) {
  const Index first = mesh.sector_begin[record];
  return first < mesh.sector_begin[record + 1] && mesh.sectors[first].shape == SectorShape::Lone;
}

template <class T>
Index coarsest_within(const std::vector<T>& errors, double limit) {
  const auto found = std::find_if(errors.begin(), errors.end(), [&](T e) { return static_cast<double>(e) <= limit; });
  if (errors.empty()) return 0;
  return static_cast<Index>(found == errors.end() ? errors.size() - 1 : found - errors.begin());
}

Result<void> expect_size(const char* name, std::size_t size, std::size_t expected) {
  if (size == expected) return {};
  return defect(text(name, " has ", size, " entries where ", expected, " are due"));
}

/// Checks that a prefix-sum array starts at `first`, never falls and ends at `last`.
template <class T>
Result<void> expect_offsets(const char* name, const std::vector<T>& offsets, std::uint64_t first, std::uint64_t last) {
  if (offsets.empty() || offsets.front() != first || offsets.back() != last ||
      !std::is_sorted(offsets.begin(), offsets.end()))
    return defect(text(name, " does not rise from ", first, " to ", last));
  return {};
}

Result<void> check_arrays(const ProgressiveMesh& mesh) {
  const std::size_t records = mesh.record_count();
  if (mesh.sector_begin.empty() || mesh.polygon_begin.empty()) return defect("record arrays are empty");
  LODESTONE_CHECK(expect_size("polygon_begin", mesh.polygon_begin.size(), mesh.sectors.size() + 1));
  LODESTONE_CHECK(expect_size("record_wedge_begin", mesh.record_wedge_begin.size(), records + 1));
  LODESTONE_CHECK(expect_size("deviation", mesh.deviation.size(), records + 1));
  LODESTONE_CHECK(expect_size("curvature_error", mesh.curvature_error.size(), records + 1));
  LODESTONE_CHECK(expect_size("positions", mesh.positions.size(), mesh.base_vertex_count + records));
  LODESTONE_CHECK(expect_offsets("sector_begin", mesh.sector_begin, 0, mesh.sectors.size()));
  LODESTONE_CHECK(expect_offsets("polygon_begin", mesh.polygon_begin, 0, mesh.polygons.size()));
  LODESTONE_CHECK(
      expect_offsets("record_wedge_begin", mesh.record_wedge_begin, mesh.base_wedge_count, mesh.wedge_vertex.size()));
  LODESTONE_CHECK(expect_offsets("round_begin", mesh.round_begin, 0, records));
  if (mesh.polygons.size() < 2 * mesh.sectors.size()) return defect("sectors have polygons of fewer than 2 corners");
  const std::size_t slots = mesh.polygons.size() - 2 * mesh.sectors.size();
  LODESTONE_CHECK(expect_size("slots", mesh.slots.size(), slots));
  LODESTONE_CHECK(expect_size("triangles", mesh.triangles.size(), 3 * slots));
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.component_count == 0 || attribute.data.size() != attribute.element_bytes() * mesh.wedge_vertex.size())
      return defect(text("attribute ", attribute.name, " has ", attribute.data.size(), " bytes for ",
                         mesh.wedge_vertex.size(), " wedges"));
  return {};
}

/// Checks that moves name vertices that are there, and go on from where those lie.
Result<void> check_moves(const ProgressiveMesh& mesh) {
  if (mesh.move_begin.empty()) return expect_size("moves", mesh.moves.size(), 0);
  LODESTONE_CHECK(expect_size("move_begin", mesh.move_begin.size(), mesh.record_count() + 1));
  LODESTONE_CHECK(expect_offsets("move_begin", mesh.move_begin, 0, mesh.moves.size()));
  std::vector<Vec3f> positions = mesh.positions;
  for (std::size_t k = 0; k < mesh.record_count(); ++k)
    for (const VertexMove& move : mesh.moves_of(k)) {
      if (move.vertex >= mesh.base_vertex_count + k)
        return defect(text(numbered("record", k), " moves vertex ", move.vertex, " before it exists"));
      if (!(move.from == positions[move.vertex]) || !is_finite(move.to))
        return defect(
            text(numbered("record", k), " moves vertex ", move.vertex, " from where it does not lie, or to nowhere"));
      positions[move.vertex] = move.to;
    }
  return {};
}

Result<void> check_values(const ProgressiveMesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (!is_finite(mesh.positions[v])) return defect(numbered("vertex", v) + " has a position that is not finite");
  }
  LODESTONE_CHECK(check_moves(mesh));
  for (std::size_t p = 0; p < mesh.deviation.size(); ++p)
    if (!is_error(mesh.deviation[p]) || !is_error(mesh.curvature_error[p]))
      return defect(numbered("position", p) + " has an error that is negative or not finite");
  for (std::size_t w = 0; w < mesh.base_wedge_count; ++w)
    if (mesh.wedge_vertex[w] >= mesh.base_vertex_count)
      return defect(text(numbered("wedge", w), " of the base mesh names vertex ", mesh.wedge_vertex[w], " of ",
                         mesh.base_vertex_count));
  for (std::size_t k = 0; k < mesh.record_count(); ++k)
    for (Index w = mesh.record_wedge_begin[k]; w < mesh.record_wedge_begin[k + 1]; ++w)
      if (mesh.wedge_vertex[w] != mesh.base_vertex_count + k)
        return defect(text(numbered("wedge", w), " of record ", k, " names vertex ", mesh.wedge_vertex[w]));
  return {};
}

Result<void> check_base(const ProgressiveMesh& mesh) {
  if (mesh.groups.empty()) return defect("mesh has no face group");
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    const std::vector<Index>& corners = mesh.groups[g].base_corners;
    if (corners.size() % 3 != 0) return defect(numbered("group", g) + " has an incomplete base face");
    const auto beyond =
        std::find_if(corners.begin(), corners.end(), [&](Index wedge) { return wedge >= mesh.base_wedge_count; });
    if (beyond != corners.end())
      return defect(
          text(numbered("group", g), " of the base mesh names wedge ", *beyond, " of ", mesh.base_wedge_count));
  }
  return {};
}

Result<void> check_sector(const ProgressiveMesh& mesh, std::size_t record, std::size_t s,
                          std::vector<std::uint64_t>& face_count) {
  const SectorHeader& sector = mesh.sectors[s];
  const std::string name = numbered("record", record);
  const std::uint64_t size = mesh.polygon_begin[s + 1] - mesh.polygon_begin[s];
  if (size != sector.polygon_size || !is_polygon_size(sector.shape, size))
    return defect(text(name, " has a polygon of ", size, " corners"));
  if (sector.group >= mesh.groups.size()) return defect(name + " names " + numbered("group", sector.group));
  if (sector.wedge >= mesh.record_wedge_begin[record + 1] - mesh.record_wedge_begin[record])
    return defect(name + " names its " + numbered("wedge", sector.wedge));
  for (std::uint64_t i = mesh.polygon_begin[s]; i < mesh.polygon_begin[s + 1]; ++i)
    if (mesh.polygons[i] >= mesh.record_wedge_begin[record])
      return defect(text(name, " names wedge ", mesh.polygons[i], " before it exists"));
  for (std::uint64_t i = mesh.slot_begin(s); i < mesh.slot_begin(s) + size - 2; ++i) {
    if (mesh.slots[i] >= face_count[sector.group])
      return defect(text(name, " names face ", mesh.slots[i], " of ", face_count[sector.group]));
    const std::uint8_t* t = &mesh.triangles[3 * i];
    if (!(t[0] < t[1] && t[1] < t[2] && t[2] < size)) return defect(name + " has a triangle outside its polygon");
  }
  return {};
}

Result<void> check_records(const ProgressiveMesh& mesh) {
  std::vector<std::uint64_t> face_count;
  for (const FaceGroup& group : mesh.groups) face_count.push_back(group.base_corners.size() / 3);
  for (std::size_t k = 0; k < mesh.record_count(); ++k) {
    for (Index s = mesh.sector_begin[k]; s < mesh.sector_begin[k + 1]; ++s)
      LODESTONE_CHECK(check_sector(mesh, k, s, face_count));
    for (Index s = mesh.sector_begin[k]; s < mesh.sector_begin[k + 1]; ++s)
      face_count[mesh.sectors[s].group] += appended_faces(mesh.sectors[s]);
  }
  for (std::size_t g = 0; g < mesh.groups.size(); ++g)
    if (face_count[g] != mesh.groups[g].face_count)
      return defect(text(numbered("group", g), " ends with ", face_count[g], " faces where ", mesh.groups[g].face_count,
                         " are due"));
  return {};
}

/// Checks that every coarse face is the one that lies in its slot, by going through all levels. Coarsening then leaves
/// no wedge behind that is gone. Pre: check_records found nothing.
Result<void> check_coarse_faces(const ProgressiveMesh& mesh) {
  for (Cursor cursor(mesh); cursor.position() < mesh.record_count(); cursor.refine()) {
    const Index record = cursor.position();
    for (Index s = mesh.sector_begin[record]; s < mesh.sector_begin[record + 1]; ++s) {
      const Index* polygon = mesh.polygons.data() + mesh.polygon_begin[s];
      const Index group = mesh.sectors[s].group;
      for (std::uint64_t i = mesh.slot_begin(s); i < mesh.slot_begin(s + 1); ++i) {
        const std::uint8_t* t = &mesh.triangles[3 * i];
        std::array<Index, 3> face;
        detail::write_canonical(face.data(), polygon[t[0]], polygon[t[1]], polygon[t[2]]);
        const auto there = cursor.corners(group).subspan(3 * std::size_t{mesh.slots[i]}, 3);
        if (!std::equal(face.begin(), face.end(), there.begin()))
          return defect(text(numbered("record", record), " does not fit ", numbered("face", mesh.slots[i]), " of ",
                             numbered("group", group)));
      }
    }
  }
  return {};
}

}  // namespace

std::vector<Vec3f> positions_at(const ProgressiveMesh& mesh, Index position) {
  const auto count = static_cast<std::ptrdiff_t>(mesh.base_vertex_count + std::size_t{position});
  std::vector<Vec3f> positions(mesh.positions.begin(), mesh.positions.begin() + count);
  const std::size_t moves = mesh.move_begin.empty() ? 0 : mesh.move_begin[position];
  for (const VertexMove& move : std::span(mesh.moves).first(moves)) positions[move.vertex] = move.to;
  return positions;
}

std::vector<Index> face_counts(const ProgressiveMesh& mesh) {
  Index count = 0;
  for (const FaceGroup& group : mesh.groups) count += static_cast<Index>(group.base_corners.size() / 3);
  std::vector<Index> counts{count};
  counts.reserve(mesh.record_count() + 1);
  for (std::size_t k = 0; k < mesh.record_count(); ++k) {
    for (Index s = mesh.sector_begin[k]; s < mesh.sector_begin[k + 1]; ++s) count += appended_faces(mesh.sectors[s]);
    counts.push_back(count);
  }
  return counts;
}

bool is_whole(const ProgressiveMesh& mesh, Index position) {
  return position == 0 || position == mesh.record_count() || !adds_lone_faces(mesh, position - 1) ||
         !adds_lone_faces(mesh, position);
}

Index position_for_deviation(const ProgressiveMesh& mesh, double deviation) {
  return coarsest_within(mesh.deviation, deviation);
}

Index position_for_curvature_error(const ProgressiveMesh& mesh, double epsilon) {
  return coarsest_within(mesh.curvature_error, epsilon);
}

Index position_for_faces(const ProgressiveMesh& mesh, std::uint64_t face_count) {
  const std::vector<Index> counts = face_counts(mesh);
  const auto beyond = std::upper_bound(counts.begin(), counts.end(), face_count);
  auto position = beyond == counts.begin() ? Index{0} : static_cast<Index>(beyond - counts.begin() - 1);
  while (!is_whole(mesh, position)) --position;
  while (position > 0 && counts[position - 1] == counts[position]) --position;  // vertices of a piece yet to come
  return position;
}

Result<void> validate(const ProgressiveMesh& mesh) {
  LODESTONE_CHECK(check_arrays(mesh));
  LODESTONE_CHECK(check_values(mesh));
  LODESTONE_CHECK(check_base(mesh));
  LODESTONE_CHECK(check_records(mesh));
  return check_coarse_faces(mesh);
}

}  // namespace lodestone

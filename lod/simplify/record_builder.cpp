#include "simplify/record_builder.h"

#include <algorithm>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/grouping.h>

#include "progressive/canonical_face.h"

namespace lodestone::detail {
/// New numbers of the full mesh's wedges, vertices and faces; faces are numbered within their group.
struct RecordBuilder::Numbering {
  explicit Numbering(const Mesh& full)
      : vertices(full.vertex_count()), wedges(full.wedge_count()), face(full.face_count(), kNoIndex) {}

  Compaction vertices;
  Compaction wedges;
  std::vector<Index> face;
  Grouping vertex_wedges;  // by vertex of the full mesh, the first of its copies: the wedges of all of them
  std::vector<Index> group_face_count;
};

RecordBuilder::RecordBuilder(const Mesh& mesh, const Connectivity& connectivity)
    : mesh_(&mesh), connectivity_(&connectivity), materials_(mesh.face_material) {
  std::sort(materials_.begin(), materials_.end());
  materials_.erase(std::unique(materials_.begin(), materials_.end()), materials_.end());
  if (materials_.empty()) materials_.push_back(0);
}

Index RecordBuilder::group_of(Index face) const {
  const auto found = std::lower_bound(materials_.begin(), materials_.end(), mesh_->material_of(face));
  return static_cast<Index>(found - materials_.begin());
}

void RecordBuilder::add(std::span<const RemovalRecord> copies, double curvature_error) {
  vertex_.push_back(connectivity_->site(copies.front().vertex));
  curvature_error_.push_back(static_cast<float>(curvature_error));
  for (const RemovalRecord& record : copies) {
    for (const SectorPatch& sector : record.sectors) {
      center_.push_back(sector.center);
      shape_.push_back(sector.shape);
      polygons_.insert(polygons_.end(), sector.polygon.begin(), sector.polygon.end());
      polygon_begin_.push_back(static_cast<Index>(polygons_.size()));
      faces_.insert(faces_.end(), sector.faces.begin(), sector.faces.end());
      face_begin_.push_back(static_cast<Index>(faces_.size()));
      triangles_.insert(triangles_.end(), sector.triangles.begin(), sector.triangles.end());
    }
  }
  sector_begin_.push_back(static_cast<Index>(center_.size()));
}

void RecordBuilder::end_round() {
  if (round_end_.empty() ? !vertex_.empty() : round_end_.back() < vertex_.size()) round_end_.push_back(vertex_.size());
}

void RecordBuilder::number_base(ProgressiveMesh& result, Numbering& numbers) const {
  const Connectivity& base = *connectivity_;
  numbers.vertex_wedges = Grouping(mesh_->vertex_count(), mesh_->wedge_count(),
                                   [&](Index wedge) { return base.site(mesh_->wedge_vertex[wedge]); });
  numbers.group_face_count.assign(materials_.size(), 0);
  for (Index v = 0; v < mesh_->vertex_count(); ++v) {
    if (!base.has_vertex(v) || base.site(v) != v) continue;
    const Index vertex = numbers.vertices.add(v);
    for (const Index wedge : numbers.vertex_wedges[v]) {
      numbers.wedges.add(wedge);
      result.wedge_vertex.push_back(vertex);
    }
  }
  result.base_vertex_count = static_cast<Index>(numbers.vertices.used().size());
  result.base_wedge_count = static_cast<Index>(result.wedge_vertex.size());
  for (std::size_t g = 0; g < materials_.size(); ++g) result.groups.push_back({materials_[g], 0, {}});
  for (Index f = 0; f < base.face_slot_count(); ++f) {
    if (!base.has_face(f)) continue;
    const Index group = group_of(f);
    numbers.face[f] = numbers.group_face_count[group]++;
    Index corners[3];
    const auto corner = [&](Index k) { return numbers.wedges.number(base.wedge(3 * f + k)); };
    write_canonical(corners, corner(0), corner(1), corner(2));
    result.groups[group].base_corners.insert(result.groups[group].base_corners.end(), corners, corners + 3);
  }
}

void RecordBuilder::number_record(std::size_t removal, ProgressiveMesh& result, Numbering& numbers) const {
  const Index source = vertex_[removal];
  const Index vertex = numbers.vertices.add(source);
  const auto number_wedge = [&](Index wedge) {
    if (numbers.wedges.add(wedge) == result.wedge_vertex.size()) result.wedge_vertex.push_back(vertex);
  };
  for (std::size_t s = sector_begin_[removal]; s < sector_begin_[removal + 1]; ++s) {
    number_wedge(center_[s]);
    const std::size_t kept = std::size_t{polygon_begin_[s + 1] - polygon_begin_[s]} - 2;
    for (std::size_t i = face_begin_[s] + kept; i < face_begin_[s + 1]; ++i)
      numbers.face[faces_[i]] = numbers.group_face_count[group_of(faces_[i])]++;
  }
  // Wedges that only finer levels use (a strip between two seams may have gone before its end did) belong here, too.
  for (const Index wedge : numbers.vertex_wedges[source]) number_wedge(wedge);
}

void RecordBuilder::write_record(std::size_t removal, ProgressiveMesh& result, const Numbering& numbers) const {
  const Index first_wedge = result.record_wedge_begin.back();
  for (std::size_t s = sector_begin_[removal]; s < sector_begin_[removal + 1]; ++s) {
    const std::size_t size = polygon_begin_[s + 1] - polygon_begin_[s];
    SectorHeader header;
    header.polygon_size = static_cast<std::uint16_t>(size);
    header.group = static_cast<std::uint16_t>(group_of(faces_[face_begin_[s]]));
    header.shape = shape_[s];
    header.wedge = static_cast<std::uint16_t>(numbers.wedges.number(center_[s]) - first_wedge);
    result.sectors.push_back(header);
    for (std::size_t i = 0; i < size; ++i)
      result.polygons.push_back(numbers.wedges.number(polygons_[polygon_begin_[s] + i]));
    result.polygon_begin.push_back(result.polygons.size());
    const std::size_t first_triangle = polygon_begin_[s] - 2 * s;
    for (std::size_t i = 0; i + 2 < size; ++i) {
      result.slots.push_back(numbers.face[faces_[face_begin_[s] + i]]);
      const PolygonTriangle t = triangles_[first_triangle + i];
      result.triangles.insert(result.triangles.end(), {t.a, t.b, t.c});
    }
  }
  result.sector_begin.push_back(static_cast<Index>(result.sectors.size()));
  result.record_wedge_begin.push_back(static_cast<Index>(result.wedge_vertex.size()));
}

void RecordBuilder::write_errors(ProgressiveMesh& result, const std::vector<float>& deviation) const {
  const std::size_t count = vertex_.size();
  result.deviation.assign(count + 1, 0);
  result.curvature_error.assign(count + 1, 0);
  float largest = 0;
  for (std::size_t removal = 0; removal < count; ++removal) {
    largest = std::max(largest, curvature_error_[removal]);
    result.curvature_error[count - 1 - removal] = largest;
    result.deviation[count - 1 - removal] = deviation[removal];
  }
  result.round_begin.push_back(0);
  for (std::size_t r = round_end_.size(); r > 1; --r)
    result.round_begin.push_back(static_cast<Index>(count - round_end_[r - 2]));
  if (count > 0) result.round_begin.push_back(static_cast<Index>(count));
}

ProgressiveMesh RecordBuilder::finish(const std::vector<float>& deviation) {
  ProgressiveMesh result;
  Numbering numbers(*mesh_);
  number_base(result, numbers);
  result.sector_begin.reserve(vertex_.size() + 1);
  result.record_wedge_begin.reserve(vertex_.size() + 1);
  result.wedge_vertex.reserve(mesh_->wedge_count());
  result.sectors.reserve(center_.size());
  result.polygon_begin.reserve(center_.size() + 1);
  result.polygons.reserve(polygons_.size());
  result.slots.reserve(triangles_.size());
  result.triangles.reserve(3 * triangles_.size());
  result.sector_begin.push_back(0);
  result.polygon_begin.push_back(0);
  result.record_wedge_begin.push_back(result.base_wedge_count);
  for (std::size_t removal = vertex_.size(); removal-- > 0;) {
    number_record(removal, result, numbers);
    write_record(removal, result, numbers);
  }
  for (std::size_t g = 0; g < result.groups.size(); ++g) result.groups[g].face_count = numbers.group_face_count[g];
  write_errors(result, deviation);
  result.positions = pick_entries(mesh_->positions, numbers.vertices.used());
  for (const Attribute& attribute : mesh_->attributes)
    result.attributes.push_back(pick_elements(attribute, numbers.wedges.used()));
  return result;
}

}  // namespace lodestone::detail

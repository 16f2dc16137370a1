#include <lodestone/lod/cursor.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "progressive/canonical_face.h"

// Progressive meshes as in Hoppe: Progressive meshes (SIGGRAPH 1996), with vertex removals in place of edge collapses:
// a record names the polygon of the hole and its triangulation, so that either way it overwrites and appends a few
// index slots.

namespace lodestone {

using detail::write_canonical;

namespace {

// Where index buffers are beyond what caches hold, the faces that a record overwrites are fetched so many records
// ahead: they lie anywhere, and each would be waited for.
constexpr std::size_t kManySlots = 500'000;
constexpr std::size_t kAhead = 16;

}  // namespace

Cursor::Cursor(const ProgressiveMesh& mesh) : mesh_(&mesh), corners_(mesh.groups.size()) {
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    corners_[g].reserve(3 * std::size_t{mesh.groups[g].face_count});
    corners_[g] = mesh.groups[g].base_corners;
    corners_[g].reserve(3 * std::size_t{mesh.groups[g].face_count});
  }
}

std::size_t Cursor::face_count() const {
  std::size_t count = 0;
  for (const std::vector<Index>& corners : corners_) count += corners.size() / 3;
  return count;
}

/// A mesh that grows does so many times: by half at least, so that not every time all is moved.
void Cursor::make_room() {
  for (std::size_t g = 0; g < corners_.size(); ++g) {
    const std::size_t wanted = 3 * std::size_t{mesh_->groups[g].face_count}, room = corners_[g].capacity();
    if (wanted > room) corners_[g].reserve(std::max(wanted, room + room / 2));
  }
}

void Cursor::seek(Index position) {
  position = std::min(position, static_cast<Index>(mesh_->record_count()));
  if (position > position_) make_room();
  const bool fetches = mesh_->slots.size() > kManySlots;
  while (position_ < position) {
    if (fetches) fetch(position_ + kAhead);
    refine();
  }
  while (position_ > position) {
    if (fetches) fetch(position_ - kAhead);  // below 0 it wraps around to no record
    coarsen();
  }
}

/// Has the faces that a record overwrites brought near, if there is such a record.
void Cursor::fetch(std::size_t record) const {
  if (record >= mesh_->record_count()) return;
  const Index first = mesh_->sector_begin[record], end = mesh_->sector_begin[record + 1];
  if (first == end) return;
  const Index* const corners = corners_[mesh_->sectors[first].group].data();  // most are of one group
  for (std::uint64_t i = mesh_->slot_begin(first); i < mesh_->slot_begin(end); ++i)
    __builtin_prefetch(corners + 3 * std::size_t{mesh_->slots[i]}, 1);
}

void Cursor::refine() {
  assert(position_ < mesh_->record_count());
  const Index first_wedge = mesh_->record_wedge_begin[position_];
  for (Index s = mesh_->sector_begin[position_]; s < mesh_->sector_begin[position_ + 1]; ++s) {
    const SectorHeader& sector = mesh_->sectors[s];
    const Index* polygon = mesh_->polygons.data() + mesh_->polygon_begin[s];
    const Index* slots = mesh_->slots.data() + mesh_->slot_begin(s);
    std::vector<Index>& corners = corners_[sector.group];
    const Index center = first_wedge + sector.wedge;
    const int size = sector.polygon_size;
    const int fine_count = size - 2 + appended_face_count(sector.shape);
    const std::size_t kept_size = corners.size();
    corners.resize(kept_size + 3 * static_cast<std::size_t>(fine_count - (size - 2)));
    // The centre is the newest wedge of all, so it stands first.
    Index* appended = corners.data() + kept_size;
    for (int i = 0; i < fine_count; ++i) {
      Index* face = i < size - 2 ? corners.data() + 3 * std::size_t{slots[i]} : appended + 3 * (i - (size - 2));
      face[0] = center;
      face[1] = polygon[i];
      face[2] = polygon[i + 1 < size ? i + 1 : 0];
    }
  }
  ++position_;
}

void Cursor::coarsen() {
  assert(position_ > 0);
  --position_;
  for (Index s = mesh_->sector_begin[position_]; s < mesh_->sector_begin[position_ + 1]; ++s) {
    const SectorHeader& sector = mesh_->sectors[s];
    const Index* polygon = mesh_->polygons.data() + mesh_->polygon_begin[s];
    const Index* slots = mesh_->slots.data() + mesh_->slot_begin(s);
    const std::uint8_t* triangle = mesh_->triangles.data() + 3 * mesh_->slot_begin(s);
    std::vector<Index>& corners = corners_[sector.group];
    corners.resize(corners.size() - 3 * static_cast<std::size_t>(appended_face_count(sector.shape)));
    for (int i = 0; i + 2 < sector.polygon_size; ++i, triangle += 3)
      write_canonical(&corners[3 * std::size_t{slots[i]}], polygon[triangle[0]], polygon[triangle[1]],
                      polygon[triangle[2]]);
  }
}

Mesh extract_level(const ProgressiveMesh& mesh, const Cursor& cursor) {
  Mesh level;
  const std::size_t wedge_count = cursor.wedge_count();
  level.positions = positions_at(mesh, cursor.position());
  level.wedge_vertex.assign(mesh.wedge_vertex.begin(),
                            mesh.wedge_vertex.begin() + static_cast<std::ptrdiff_t>(wedge_count));
  for (const Attribute& attribute : mesh.attributes) {
    Attribute& copy = level.attributes.emplace_back(
        Attribute{attribute.name, attribute.type, attribute.component_count, attribute.normalized, {}});
    copy.data.assign(attribute.data.begin(),
                     attribute.data.begin() + static_cast<std::ptrdiff_t>(wedge_count * attribute.element_bytes()));
  }
  const bool has_materials = mesh.groups.size() > 1 || (!mesh.groups.empty() && mesh.groups[0].material != 0);
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) {
    const std::span<const Index> corners = cursor.corners(g);
    level.corner_wedge.insert(level.corner_wedge.end(), corners.begin(), corners.end());
    if (has_materials)
      level.face_material.insert(level.face_material.end(), corners.size() / 3, mesh.groups[g].material);
  }
  return level;
}

Mesh extract_level(const ProgressiveMesh& mesh, Index position) {
  Cursor cursor(mesh);
  cursor.seek(position);
  return extract_level(mesh, cursor);
}

}  // namespace lodestone

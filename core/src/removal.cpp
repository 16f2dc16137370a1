// Removal of a vertex and retriangulation of its hole, after Schroeder, Zarge, Lorensen: Decimation of triangle meshes
// (SIGGRAPH 1992), kept reversible: the coarse faces reuse the slots of fine ones, and nothing outside the star moves.

#include <lodestone/core/removal.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <unordered_set>
#include <utility>

namespace lodestone {

/// The one place that writes to a connectivity.
struct PatchAccess {
  Connectivity& mesh;

  void set_face(Index face, std::array<Index, 3> wedges) const {
    for (Index i = 0; i < 3; ++i) mesh.corner_wedge_[3 * face + i] = wedges[i];
    clear_edges(face);
  }
  void kill_face(Index face) const { set_face(face, {kNoIndex, kNoIndex, kNoIndex}); }
  void clear_edges(Index face) const {
    for (Index i = 0; i < 3; ++i) {
      mesh.opposite_[3 * face + i] = kNoIndex;
      if (!mesh.crease_.empty()) mesh.crease_[3 * face + i] = 0;
    }
  }
  /// Makes two corners face the same edge; either may be kNoIndex: then the other faces a border.
  void join(Index a, Index b, bool crease) const {
    for (const auto& [corner, across] : {std::pair{a, b}, std::pair{b, a}}) {
      if (corner == kNoIndex) continue;
      mesh.opposite_[corner] = across;
      if (!mesh.crease_.empty()) mesh.crease_[corner] = crease ? 1 : 0;
    }
  }
  void set_anchor(Index vertex, Index corner) const { mesh.vertex_corner_[vertex] = corner; }
  void anchor(Index corner) const { mesh.vertex_corner_[mesh.vertex(corner)] = mesh.first_corner(corner); }
  void add_faces(std::ptrdiff_t count) const {
    mesh.face_count_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(mesh.face_count_) + count);
  }
};

namespace {

/// An edge of the hole's rim, as seen from inside: the corner beyond it that faces it.
struct RimEdge {
  Index outer = kNoIndex;
  bool crease = false;
};

/// The corners of a sector's coarse faces, by the directed polygon edge they face.
class CoarseEdges {
 public:
  explicit CoarseEdges(const SectorPatch& sector) : size_(sector.polygon.size()), corner_(size_ * size_, kNoIndex) {
    for (std::size_t i = 0; i < sector.triangles.size(); ++i) {
      const PolygonTriangle t = sector.triangles[i];
      const Index corner = 3 * sector.faces[i];
      at(t.b, t.c) = corner;
      at(t.c, t.a) = corner + 1;
      at(t.a, t.b) = corner + 2;
    }
  }
  Index& at(std::size_t from, std::size_t to) { return corner_[from * size_ + to]; }
  Index rim(std::size_t i) { return at(i, (i + 1) % size_); }
  Index closing() { return at(size_ - 1, 0); }

 private:
  std::size_t size_;
  std::vector<Index> corner_;
};

Index center_corner(const SectorPatch& sector, std::size_t face) {
  return 3 * sector.faces[face] + sector.rotation[face];
}

void save_anchors(const Connectivity& mesh, RemovalRecord& record) {
  record.vertex_corner = mesh.corner_at(record.vertex);
  for (SectorPatch& sector : record.sectors) {
    sector.anchors.clear();
    for (const Index wedge : sector.polygon) sector.anchors.push_back(mesh.corner_at(mesh.vertex_of_wedge(wedge)));
  }
}

std::vector<RimEdge> fine_rim(const Connectivity& mesh, const SectorPatch& sector) {
  std::vector<RimEdge> rim(sector.face_count());
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Index corner = center_corner(sector, i);
    rim[i] = {mesh.opposite(corner), mesh.is_crease(corner)};
  }
  return rim;
}

std::vector<RimEdge> coarse_rim(const Connectivity& mesh, const SectorPatch& sector) {
  if (sector.polygon.size() == 2) return {{sector.lone_outer, sector.lone_crease}};
  CoarseEdges edges(sector);
  std::vector<RimEdge> rim(sector.face_count());
  for (std::size_t i = 0; i < rim.size(); ++i) rim[i] = {mesh.opposite(edges.rim(i)), mesh.is_crease(edges.rim(i))};
  return rim;
}

/// The corners that face the two edges at which a filled sector meets its neighbours; kNoIndex at a border.
struct SectorEnds {
  Index entry = kNoIndex;
  Index exit = kNoIndex;
};

/// Replaces a sector's fine faces by its coarse ones.
SectorEnds write_coarse_faces(const PatchAccess& access, SectorPatch& sector) {
  const std::vector<RimEdge> rim = fine_rim(access.mesh, sector);
  const std::size_t size = sector.polygon.size();
  for (std::size_t i = 0; i < sector.face_count(); ++i) {
    if (i >= sector.triangles.size()) {
      access.kill_face(sector.faces[i]);
      continue;
    }
    const PolygonTriangle t = sector.triangles[i];
    access.set_face(sector.faces[i], {sector.polygon[t.a], sector.polygon[t.b], sector.polygon[t.c]});
  }
  if (size == 2) {
    sector.lone_outer = rim[0].outer;
    sector.lone_crease = rim[0].crease;
    return {sector.lone_outer, sector.lone_outer};
  }
  CoarseEdges edges(sector);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = i + 1; j < size; ++j)
      if (edges.at(i, j) != kNoIndex && edges.at(j, i) != kNoIndex) access.join(edges.at(i, j), edges.at(j, i), false);
  for (std::size_t i = 0; i < rim.size(); ++i) access.join(edges.rim(i), rim[i].outer, rim[i].crease);
  if (sector.shape == SectorShape::Closed) return {};
  const Index closing = edges.closing();
  return {closing, sector.shape == SectorShape::Moved ? edges.at(size - 2, size - 1) : closing};
}

/// Joins neighbouring sectors at their new constrained edges.
void join_ends(const PatchAccess& access, const RemovalRecord& record, const std::vector<SectorEnds>& ends) {
  const std::size_t count = record.sectors.size();
  // The first and the last end of an open star face its border.
  if (record.open_star)
    access.join(ends.front().entry, kNoIndex, false), access.join(ends.back().exit, kNoIndex, false);
  const auto is_open = [&](std::size_t s) { return record.sectors[s].shape == SectorShape::Open; };
  if (count == 2 && is_open(0) && is_open(1) && !record.open_star) {
    access.join(ends[0].exit, ends[1].entry, record.sectors[0].starts_at_crease || record.sectors[1].starts_at_crease);
    return;
  }
  for (std::size_t s = record.open_star ? 1 : 0; s < count && count > 1; ++s) {
    const std::size_t before = (s + count - 1) % count;
    if (is_open(before) && is_open(s)) continue;  // between them lay the spoke to the target
    access.join(ends[before].exit, ends[s].entry, record.sectors[s].starts_at_crease);
  }
}

void write_fine_faces(const PatchAccess& access, const SectorPatch& sector) {
  const std::vector<RimEdge> rim = coarse_rim(access.mesh, sector);
  const std::size_t size = sector.polygon.size();
  for (std::size_t i = 0; i < sector.face_count(); ++i) {
    std::array<Index, 3> wedges{};
    wedges[sector.rotation[i]] = sector.center;
    wedges[(sector.rotation[i] + 1) % 3] = sector.polygon[i];
    wedges[(sector.rotation[i] + 2) % 3] = sector.polygon[(i + 1) % size];
    access.set_face(sector.faces[i], wedges);
  }
  for (std::size_t i = 0; i < sector.face_count(); ++i) {
    const Index corner = center_corner(sector, i);
    access.join(corner, rim[i].outer, rim[i].crease);
    if (i > 0) access.join(next_corner(center_corner(sector, i - 1)), previous_corner(corner), false);
  }
}

/// Joins the sectors' first and last spokes with one another, around the restored vertex.
void join_spokes(const PatchAccess& access, const RemovalRecord& record) {
  const std::size_t count = record.sectors.size();
  if (record.sectors[0].shape == SectorShape::Closed) {
    const SectorPatch& ring = record.sectors[0];
    access.join(next_corner(center_corner(ring, ring.face_count() - 1)), previous_corner(center_corner(ring, 0)),
                false);
    return;
  }
  for (std::size_t s = 0; s < count; ++s) {
    const SectorPatch& before = record.sectors[(s + count - 1) % count];
    const SectorPatch& sector = record.sectors[s];
    const Index last = next_corner(center_corner(before, before.face_count() - 1));
    const Index first = previous_corner(center_corner(sector, 0));
    if (s > 0 || !record.open_star) access.join(last, first, sector.starts_at_crease);
  }
}

/// Anchors each vertex of a filled polygon: at the last corner that it has there, or where its border begins.
void anchor_polygon(const PatchAccess& access, const SectorPatch& sector) {
  std::array<Index, std::numeric_limits<std::uint8_t>::max() + 1> last;  // by polygon corner
  for (std::size_t i = 0; i < sector.triangles.size(); ++i) {
    const PolygonTriangle t = sector.triangles[i];
    const Index corner = 3 * sector.faces[i];
    last[t.a] = corner, last[t.b] = corner + 1, last[t.c] = corner + 2;
  }
  for (std::size_t i = 0; i < sector.polygon.size(); ++i) access.anchor(last[i]);
}

void anchor_ring(const PatchAccess& access, const RemovalRecord& record) {
  for (const SectorPatch& sector : record.sectors) {
    if (sector.polygon.size() > 2) anchor_polygon(access, sector);
    if (sector.polygon.size() > 2 || sector.lone_outer == kNoIndex) continue;
    access.anchor(next_corner(sector.lone_outer));
    access.anchor(previous_corner(sector.lone_outer));
  }
}

std::ptrdiff_t removed_faces(const RemovalRecord& record) {
  std::ptrdiff_t count = 0;
  for (const SectorPatch& sector : record.sectors)
    count += static_cast<std::ptrdiff_t>(sector.face_count()) - static_cast<std::ptrdiff_t>(sector.triangles.size());
  return count;
}

}  // namespace

namespace {

/// Fills a sector with the faces [begin, end) of the star.
void describe_faces(const Connectivity& mesh, const Star& star, Index begin, Index end, SectorPatch& sector) {
  sector.polygon.clear();
  sector.faces.clear();
  sector.rotation.clear();
  sector.triangles.clear();
  sector.lone_outer = kNoIndex;
  sector.center = mesh.wedge(star.corners[begin]);
  sector.starts_at_crease = mesh.is_crease(previous_corner(star.corners[begin]));
  for (Index i = begin; i < end; ++i) {
    const Index corner = star.corners[i];
    sector.polygon.push_back(mesh.wedge(next_corner(corner)));
    sector.faces.push_back(face_of_corner(corner));
    sector.rotation.push_back(static_cast<std::uint8_t>(corner % 3));
  }
}

void start_record(const Connectivity& mesh, const Star& star, RemovalRecord& record) {
  record.vertex = mesh.vertex(star.corners.front());
  record.target = kNoIndex;
  record.open_star = !star.closed;
}

}  // namespace

void describe_removal(const Connectivity& mesh, const Star& star, RemovalRecord& record) {
  start_record(mesh, star, record);
  record.sectors.resize(star.sector_count());
  for (std::size_t s = 0; s < star.sector_count(); ++s) {
    SectorPatch& sector = record.sectors[s];
    describe_faces(mesh, star, star.sector_begin[s], star.sector_end(s), sector);
    sector.shape = star.is_plain() ? SectorShape::Closed : SectorShape::Open;
    if (sector.shape == SectorShape::Open)
      sector.polygon.push_back(mesh.wedge(previous_corner(star.corners[star.sector_end(s) - 1])));
  }
}

void describe_collapse(const Connectivity& mesh, const Star& star, Index target, RemovalRecord& record) {
  start_record(mesh, star, record);
  const auto face_count = static_cast<Index>(star.corners.size());
  assert(target < face_count || (!star.closed && target == face_count));
  const Index target_wedge = target < face_count ? mesh.wedge(next_corner(star.corners[target]))
                                                 : mesh.wedge(previous_corner(star.corners.back()));
  record.target = mesh.vertex_of_wedge(target_wedge);
  std::vector<Index> begin = star.sector_begin;
  if (target < face_count && !std::binary_search(begin.begin(), begin.end(), target))
    begin.insert(std::lower_bound(begin.begin(), begin.end(), target), target);
  record.sectors.resize(begin.size());
  for (std::size_t s = 0; s < begin.size(); ++s) {
    SectorPatch& sector = record.sectors[s];
    const Index end = s + 1 < begin.size() ? begin[s + 1] : face_count;
    describe_faces(mesh, star, begin[s], end, sector);
    sector.polygon.push_back(mesh.wedge(previous_corner(star.corners[end - 1])));
    const bool touches_target =
        begin[s] == target || end == target || (star.closed && target == 0 && end == face_count);
    sector.shape = touches_target ? SectorShape::Open : SectorShape::Moved;
    if (!touches_target) sector.polygon.push_back(target_wedge);
  }
}

void remove_vertex(Connectivity& mesh, RemovalRecord& record) {
  const PatchAccess access{mesh};
  save_anchors(mesh, record);
  std::vector<SectorEnds> ends;
  ends.reserve(record.sectors.size());
  for (SectorPatch& sector : record.sectors) ends.push_back(write_coarse_faces(access, sector));
  join_ends(access, record, ends);
  access.set_anchor(record.vertex, kNoIndex);
  anchor_ring(access, record);
  access.add_faces(-removed_faces(record));
}

void restore_vertex(Connectivity& mesh, const RemovalRecord& record) {
  const PatchAccess access{mesh};
  for (const SectorPatch& sector : record.sectors) write_fine_faces(access, sector);
  join_spokes(access, record);
  access.set_anchor(record.vertex, record.vertex_corner);
  for (const SectorPatch& sector : record.sectors)
    for (std::size_t i = 0; i < sector.polygon.size(); ++i)
      access.set_anchor(mesh.vertex_of_wedge(sector.polygon[i]), sector.anchors[i]);
  access.add_faces(removed_faces(record));
}

namespace {

/// The faces at some vertices, ascending.
std::vector<Index> faces_of(const Connectivity& mesh, std::span<const Index> vertices) {
  std::vector<Index> faces;
  Star star;
  for (const Index v : vertices) {
    if (!mesh.has_vertex(v)) continue;
    mesh.gather_star(v, star);
    for (const Index corner : star.corners) faces.push_back(face_of_corner(corner));
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

SectorPatch lone_face(const Connectivity& mesh, Index corner) {
  SectorPatch sector;
  sector.shape = SectorShape::Lone;
  sector.center = mesh.wedge(corner);
  sector.polygon = {mesh.wedge(next_corner(corner)), mesh.wedge(previous_corner(corner))};
  sector.faces = {face_of_corner(corner)};
  sector.rotation = {static_cast<std::uint8_t>(corner % 3)};
  return sector;
}

/// Whether no face lies across an edge of these that is not one of them; in release builds nobody asks.
[[maybe_unused]] bool is_whole_component(const Connectivity& mesh, const std::vector<Index>& faces) {
  return std::all_of(faces.begin(), faces.end(), [&](Index face) {
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const Index across = mesh.opposite(corner);
      if (across != kNoIndex && !std::binary_search(faces.begin(), faces.end(), face_of_corner(across))) return false;
    }
    return true;
  });
}

}  // namespace

std::vector<RemovalRecord> remove_component(Connectivity& mesh, std::span<const Index> vertices) {
  const std::vector<Index> faces = faces_of(mesh, vertices);
  assert(is_whole_component(mesh, faces));
  std::vector<std::array<Index, 3>> corners;  // (site, vertex, corner): in this order copies stand together
  for (const Index face : faces)
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner)
      corners.push_back({mesh.site(mesh.vertex(corner)), mesh.vertex(corner), corner});
  std::sort(corners.begin(), corners.end());
  std::vector<RemovalRecord> records;
  std::unordered_set<Index> gone;
  for (const auto& [site, v, corner] : corners) {
    if (records.empty() || records.back().vertex != v) {
      RemovalRecord& record = records.emplace_back();
      record.vertex = v;
      record.vertex_corner = mesh.corner_at(v);
      record.open_star = true;
    }
    if (gone.insert(face_of_corner(corner)).second) records.back().sectors.push_back(lone_face(mesh, corner));
  }
  // All copies of a vertex come last together, or none.
  std::unordered_set<Index> with_faces;
  for (const RemovalRecord& record : records)
    if (!record.sectors.empty()) with_faces.insert(mesh.site(record.vertex));
  std::stable_partition(records.begin(), records.end(),
                        [&](const RemovalRecord& record) { return with_faces.contains(mesh.site(record.vertex)); });
  const PatchAccess access{mesh};
  for (const Index face : faces) access.kill_face(face);
  for (const RemovalRecord& record : records) access.set_anchor(record.vertex, kNoIndex);
  access.add_faces(-static_cast<std::ptrdiff_t>(faces.size()));
  return records;
}

}  // namespace lodestone

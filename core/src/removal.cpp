// Removal of a vertex and retriangulation of its hole, after Schroeder, Zarge, Lorensen: Decimation of triangle meshes
// (SIGGRAPH 1992), kept reversible: the coarse faces reuse the slots of fine ones, and nothing outside the star moves.

#include <lodestone/core/removal.h>

#include <array>
#include <cassert>
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
  if (sector.polygon.size() == 2)
    return {{sector.lone_outer, sector.lone_outer != kNoIndex && mesh.is_crease(sector.lone_outer)}};
  CoarseEdges edges(sector);
  std::vector<RimEdge> rim(sector.face_count());
  for (std::size_t i = 0; i < rim.size(); ++i) rim[i] = {mesh.opposite(edges.rim(i)), mesh.is_crease(edges.rim(i))};
  return rim;
}

/// Replaces a sector's fine faces by its coarse ones; returns the corner that faces the closing edge of an open one.
Index write_coarse_faces(const PatchAccess& access, SectorPatch& sector) {
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
  if (size == 2) return sector.lone_outer = rim[0].outer;
  CoarseEdges edges(sector);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = i + 1; j < size; ++j)
      if (edges.at(i, j) != kNoIndex && edges.at(j, i) != kNoIndex) access.join(edges.at(i, j), edges.at(j, i), false);
  for (std::size_t i = 0; i < rim.size(); ++i) access.join(edges.rim(i), rim[i].outer, rim[i].crease);
  return sector.closed ? kNoIndex : edges.closing();
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
void join_sectors(const PatchAccess& access, const RemovalRecord& record) {
  const std::size_t count = record.sectors.size();
  const bool open_ring = count == 1 && !record.sectors[0].closed;
  for (std::size_t s = 0; s < count; ++s) {
    const SectorPatch& before = record.sectors[(s + count - 1) % count];
    const SectorPatch& sector = record.sectors[s];
    const Index last = next_corner(center_corner(before, before.face_count() - 1));
    const Index first = previous_corner(center_corner(sector, 0));
    if (!open_ring) access.join(last, first, sector.starts_at_crease);
  }
}

void anchor_ring(const PatchAccess& access, const RemovalRecord& record, Index closing) {
  for (const SectorPatch& sector : record.sectors)
    for (std::size_t i = 0; i < sector.triangles.size(); ++i)
      for (Index k = 0; k < 3; ++k) access.anchor(3 * sector.faces[i] + k);
  if (closing == kNoIndex) return;
  access.anchor(next_corner(closing));
  access.anchor(previous_corner(closing));
}

std::ptrdiff_t removed_faces(const RemovalRecord& record) {
  std::ptrdiff_t count = 0;
  for (const SectorPatch& sector : record.sectors)
    count += static_cast<std::ptrdiff_t>(sector.face_count()) - static_cast<std::ptrdiff_t>(sector.triangles.size());
  return count;
}

}  // namespace

void describe_sectors(const Connectivity& mesh, const Star& star, std::vector<SectorPatch>& sectors) {
  sectors.resize(star.sector_count());
  for (std::size_t s = 0; s < star.sector_count(); ++s) {
    SectorPatch& sector = sectors[s];
    sector.polygon.clear();
    sector.faces.clear();
    sector.rotation.clear();
    sector.triangles.clear();
    sector.closed = star.is_plain();
    sector.center = mesh.wedge(star.corners[star.sector_begin[s]]);
    sector.starts_at_crease = mesh.is_crease(previous_corner(star.corners[star.sector_begin[s]]));
    for (Index i = star.sector_begin[s]; i < star.sector_end(s); ++i) {
      const Index corner = star.corners[i];
      sector.polygon.push_back(mesh.wedge(next_corner(corner)));
      sector.faces.push_back(face_of_corner(corner));
      sector.rotation.push_back(static_cast<std::uint8_t>(corner % 3));
    }
    if (!sector.closed) sector.polygon.push_back(mesh.wedge(previous_corner(star.corners[star.sector_end(s) - 1])));
  }
}

void remove_vertex(Connectivity& mesh, RemovalRecord& record) {
  assert(record.sectors.size() == 1 || record.sectors.size() == 2);
  const PatchAccess access{mesh};
  save_anchors(mesh, record);
  std::array<Index, 2> closing{kNoIndex, kNoIndex};
  bool crease = false;
  for (std::size_t s = 0; s < record.sectors.size(); ++s) {
    closing[s] = write_coarse_faces(access, record.sectors[s]);
    crease = crease || record.sectors[s].starts_at_crease;
  }
  if (!record.sectors[0].closed) access.join(closing[0], closing[1], crease && record.sectors.size() == 2);
  access.set_anchor(record.vertex, kNoIndex);
  anchor_ring(access, record, closing[0] != kNoIndex ? closing[0] : closing[1]);
  access.add_faces(-removed_faces(record));
}

void restore_vertex(Connectivity& mesh, const RemovalRecord& record) {
  const PatchAccess access{mesh};
  for (const SectorPatch& sector : record.sectors) write_fine_faces(access, sector);
  join_sectors(access, record);
  access.set_anchor(record.vertex, record.vertex_corner);
  for (const SectorPatch& sector : record.sectors)
    for (std::size_t i = 0; i < sector.polygon.size(); ++i)
      access.set_anchor(mesh.vertex_of_wedge(sector.polygon[i]), sector.anchors[i]);
  access.add_faces(removed_faces(record));
}

}  // namespace lodestone

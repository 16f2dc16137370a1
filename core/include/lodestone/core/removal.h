#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/sector_shape.h>
#include <lodestone/core/triangulation.h>

namespace lodestone {

/// One side of a removal; the rules are those of `SectorHeader` in lod: coarse face i takes the place of fine face i.
struct SectorPatch {
  Index center = kNoIndex;  ///< the removed vertex's wedge on this side
  SectorShape shape = SectorShape::Open;
  std::vector<Index> polygon;              ///< wedges, counter-clockwise
  std::vector<Index> faces;                ///< fine faces (v, p(i), p(i+1))
  std::vector<std::uint8_t> rotation;      ///< which corner of each fine face is the removed vertex
  std::vector<PolygonTriangle> triangles;  ///< the coarse faces
  std::vector<Index> anchors;              ///< filled by remove_vertex: the polygon vertices' anchors before it
  Index lone_outer = kNoIndex;             ///< filled by remove_vertex where polygon size is 2: the corner beyond
  bool lone_crease = false;                ///< the same: whether that corner faced a crease
  bool starts_at_crease = false;           ///< whether the spoke to polygon corner 0 is a crease

  std::size_t face_count() const { return faces.size(); }
};

/// What one removal needs to be undone.
struct RemovalRecord {
  Index vertex = kNoIndex;
  Index vertex_corner = kNoIndex;    ///< the vertex's anchor before the removal
  Index target = kNoIndex;           ///< the vertex it moves to; kNoIndex where its hole is retriangulated
  bool open_star = false;            ///< whether the vertex lies on a border
  std::vector<SectorPatch> sectors;  ///< counter-clockwise
};

/// Describes a removal whose hole is retriangulated: one polygon for each sector of the star. `triangles` stay empty.
/// Pre: the vertex is interior, border or feature.
void describe_removal(const Connectivity& mesh, const Star& star, RemovalRecord& record);

/// Describes a removal that moves the vertex to a neighbour, taking along every constrained edge that meets at it: the
/// one kind of removal that corners have. `target` is the number of a spoke: the neighbour before face `target` of the
/// star, or the last one of an open star. Each polygon is to be filled with the fan of that neighbour. In the sectors
/// away from it the neighbour's wedge, `polygon.back()`, is any of its wedges; the caller may put a better one.
/// Pre: the star has a constrained spoke other than `target`.
void describe_collapse(const Connectivity& mesh, const Star& star, Index target, RemovalRecord& record);

/// Removes a vertex and fills its hole with the triangles given in `record.sectors`.
///
/// Pre: `record` comes from one of the functions above, with polygon_size − 2 triangles in each sector that triangulate
/// the polygon; the removal keeps the mesh simple (no edge appears twice).
void remove_vertex(Connectivity& mesh, RemovalRecord& record);

/// Undoes the last removal: the mesh is again as it was before it, byte for byte.
void restore_vertex(Connectivity& mesh, const RemovalRecord& record);

/// Removes a whole component: everything that hangs together over edges and over copies of vertices.
///
/// Pre: `vertices` are all of its vertices; there may be removed ones among them.
/// Returns one record for each vertex and copy, copies of one vertex next to each other. A record's sectors are its
/// faces that no earlier record has, each a lone one; vertices without any come last. Only whole components can go this
/// way, so there is no function that undoes it; a `Cursor` over the records goes both ways.
std::vector<RemovalRecord> remove_component(Connectivity& mesh, std::span<const Index> vertices);

}  // namespace lodestone

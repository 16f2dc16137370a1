#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/triangulation.h>

namespace lodestone {

/// One side of a removal; the rules are those of `SectorHeader` in lod: coarse face i takes the place of fine face i.
struct SectorPatch {
  Index center = kNoIndex;                 ///< the removed vertex's wedge on this side
  bool closed = false;                     ///< whether the polygon is a closed ring
  std::vector<Index> polygon;              ///< wedges, counter-clockwise
  std::vector<Index> faces;                ///< fine faces: one for each polygon edge, but for the closing edge if open
  std::vector<std::uint8_t> rotation;      ///< which corner of each fine face is the removed vertex
  std::vector<PolygonTriangle> triangles;  ///< the coarse faces
  std::vector<Index> anchors;              ///< filled by remove_vertex: the polygon vertices' anchors before it
  Index lone_outer = kNoIndex;             ///< filled by remove_vertex where polygon size is 2: the corner beyond
  bool starts_at_crease = false;           ///< whether the spoke to polygon corner 0 is a crease

  std::size_t face_count() const { return faces.size(); }
};

/// What one removal needs to be undone.
struct RemovalRecord {
  Index vertex = kNoIndex;
  Index vertex_corner = kNoIndex;    ///< the vertex's anchor before the removal
  std::vector<SectorPatch> sectors;  ///< one, or two where a feature line passes through the vertex
};

/// Fills `sectors` with the polygons around a vertex, one for each sector of its star; `triangles` stay empty.
void describe_sectors(const Connectivity& mesh, const Star& star, std::vector<SectorPatch>& sectors);

/// Removes a vertex and fills its hole with the triangles given in `record.sectors`.
///
/// Pre: `record.sectors` comes from `describe_sectors`, with polygon_size − 2 triangles each that triangulate the
/// polygon; the vertex is interior, border or feature; the removal keeps the mesh simple (no edge appears twice).
void remove_vertex(Connectivity& mesh, RemovalRecord& record);

/// Undoes the last removal: the mesh is again as it was before it, byte for byte.
void restore_vertex(Connectivity& mesh, const RemovalRecord& record);

}  // namespace lodestone

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/core/sector_shape.h>

namespace lodestone {

/// One side of a removed vertex's star between two constrained edges; the whole star where there are none.
///
/// The polygon p0 … p(m−1) lists the ring counter-clockwise; `SectorShape` says how it lies. The *fine* faces are the
/// triangles (v, p(i), p(i+1)), m − 2 + appended_face_count(shape) of them. The *coarse* faces are the m − 2 triangles
/// that replaced them. Coarse face i and fine face i share one slot of their group's index buffer; the remaining fine
/// faces are appended to it.
struct SectorHeader {
  std::uint16_t polygon_size = 0;  ///< m: ≥ 3; ≥ 2 if open, 2 if lone
  std::uint16_t group = 0;         ///< which index buffer (material) the faces belong to
  std::uint16_t wedge = 0;         ///< which of the record's new wedges is this side's centre
  SectorShape shape = SectorShape::Open;
};

/// Returns how many more faces a sector has after its record than before: 1 if open or lone, 2 if closed, 0 if moved.
constexpr int appended_face_count(SectorShape shape) {
  return shape == SectorShape::Closed ? 2 : shape == SectorShape::Moved ? 0 : 1;
}

/// The faces that share a material; each group has an index buffer of its own.
struct FaceGroup {
  Index material = 0;
  Index face_count = 0;             ///< at full detail
  std::vector<Index> base_corners;  ///< 3 wedges for each face of the base mesh, in the canonical rotation
};

/// A vertex that a record moves, besides the one that it creates.
struct VertexMove {
  Index vertex = 0;  ///< of the level before the record
  Vec3f from, to;
};

/// A base mesh and the records that refine it, coarse to fine.
///
/// *Numbering.* Vertices, wedges and faces stand in the order of their creation: record k creates vertex
/// base_vertex_count + k and the wedges from record_wedge_begin[k] on, and appends faces at the end of its groups.
/// The copies that a vertex was cut into (see `assemble`) are one vertex again, and leave by one record.
/// Position p, in 0 … record_count(), is the level after the first p records; it uses the first
/// base_vertex_count + p vertices. Refining appends, coarsening pops.
///
/// *Canonical rotation.* A face is stored with its largest wedge number first, winding kept. Refining and coarsening
/// then are exact inverses, byte for byte, without storing any rotation.
///
/// *Record payload.* sector_begin[k] … sector_begin[k+1] are record k's sectors. Sector s owns, in `polygons`,
/// polygon_size wedges from polygon_begin[s] on; in `slots`, polygon_size − 2 face slots of its group from
/// slot_begin(s) on; and in `triangles`, three bytes for each of those: the local polygon indices a < b < c of the
/// coarse face. slot_begin(s) = polygon_begin[s] − 2·s, since each sector has two slots fewer than polygon corners.
///
/// *Moves.* Levels of records that only add vertices have the finest mesh's vertices. Where levels are to lie closer to
/// it, records move vertices on the way: `positions` then says where each lies when it is created, and moves
/// move_begin[k] … move_begin[k+1] of record k, where it goes. Each move begins where the vertex lies.
///
/// *Errors.* deviation[p] bounds the two-sided (Hausdorff) distance between level p and the full mesh, in mesh units;
/// curvature_error[p] is the largest curvature error ε of the removals that lead from the full mesh to level p, in the
/// metric's own unit. Both have record_count() + 1 entries and end with 0.
struct ProgressiveMesh {
  std::vector<Vec3f> positions;       ///< one per vertex
  std::vector<Index> wedge_vertex;    ///< one per wedge, non-decreasing
  std::vector<Attribute> attributes;  ///< each with one element per wedge
  std::vector<FaceGroup> groups;      ///< at least one

  Index base_vertex_count = 0;
  Index base_wedge_count = 0;

  std::vector<Index> record_wedge_begin;  ///< record_count() + 1, first base_wedge_count, last wedge count
  std::vector<Index> sector_begin;        ///< record_count() + 1, first 0
  std::vector<SectorHeader> sectors;
  std::vector<std::uint64_t> polygon_begin;  ///< sectors.size() + 1, first 0
  std::vector<Index> polygons;               ///< wedges
  std::vector<Index> slots;                  ///< faces of the sector's group
  std::vector<std::uint8_t> triangles;       ///< 3 local polygon indices for each slot

  std::vector<Index> move_begin;  ///< record_count() + 1, first 0; or empty where no record moves anything
  std::vector<VertexMove> moves;

  std::vector<Index> round_begin;      ///< round r holds records [round_begin[r], round_begin[r+1]), coarse to fine
  std::vector<float> deviation;        ///< record_count() + 1, mesh units
  std::vector<float> curvature_error;  ///< record_count() + 1, radians or mesh units, by metric

  std::size_t record_count() const { return sector_begin.empty() ? 0 : sector_begin.size() - 1; }
  std::size_t vertex_count() const { return positions.size(); }
  std::uint64_t slot_begin(std::size_t sector) const { return polygon_begin[sector] - 2 * sector; }
  std::span<const VertexMove> moves_of(std::size_t record) const {
    if (move_begin.empty()) return {};
    return std::span(moves).subspan(move_begin[record], move_begin[record + 1] - move_begin[record]);
  }
};

/// Returns where the vertices of a level lie, base_vertex_count + position of them. Cost: linear in these and the
/// moves.
std::vector<Vec3f> positions_at(const ProgressiveMesh& mesh, Index position);

/// Returns the faces of every position, record_count() + 1 entries, ascending.
std::vector<Index> face_counts(const ProgressiveMesh& mesh);

/// Returns whether every piece of the mesh is there as a whole, or not at all, at a position. A piece that vanishes
/// does so over several records, one for each of its vertices; between them stands a part of it.
bool is_whole(const ProgressiveMesh& mesh, Index position);

/// Returns the coarsest position whose deviation bound is at most `deviation` (mesh units); record_count() at worst.
Index position_for_deviation(const ProgressiveMesh& mesh, double deviation);

/// Returns the coarsest position whose curvature error is at most `epsilon` (the metric's own unit).
Index position_for_curvature_error(const ProgressiveMesh& mesh, double epsilon);

/// Returns the finest whole position with at most `face_count` faces; 0 where even the base mesh has more. Of positions
/// that differ only by vertices without faces, of pieces yet to come, the coarsest.
Index position_for_faces(const ProgressiveMesh& mesh, std::uint64_t face_count);

/// Checks every length, index and count of a mesh that came from outside, and that coarse faces are those they replace:
/// so that any cursor over it stays in bounds, and comes back to where it was.
/// Errors: Malformed, naming the record and the number at fault. Cost: one replay of all records.
Result<void> validate(const ProgressiveMesh& mesh);

}  // namespace lodestone

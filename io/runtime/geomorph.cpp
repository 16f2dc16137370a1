#include <lodestone/io/geomorph.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <tuple>

#include "runtime/vertex_moves.h"

// Geomorphs as in Hoppe: Progressive meshes (SIGGRAPH 1996) and Efficient implementation of progressive meshes
// (Computers & Graphics 22, 1998): the fine level's faces, whose new vertices slide out of vertices of the coarse one.
// There a new vertex has an ancestor by construction, the one that was split, and wedges inherit attributes by the
// cases of a split. Here it is chosen among the corners of the patch that a removal left, as if that had been a
// collapse into the corner: which it is where the patch is a fan around it.
//
// A vertex could begin inside its patch, at the point nearest to it. Ways would be shorter, and hardly a face would
// fold over on the way; but faces at t = 0 lie on a patch only where that is flat or a triangle, so that most of what
// pops without a morph would pop with it (measured in docs/decisions.md), and attributes would have to be interpolated,
// which joints cannot be and nothing else here does with any.

namespace lodestone {
namespace {

constexpr std::size_t kMostCorners = 256;  // of a polygon that triangles can meet in: they have bytes for corners

/// One side of the vertex that a record adds.
struct Sector {
  SectorShape shape;
  Index wedge;                     // of the vertex
  std::span<const Index> polygon;  // wedges
  const std::uint8_t* triangles;   // three corners of the polygon each, polygon.size() − 2 of them
};

Sector sector_of(const ProgressiveMesh& mesh, Index record, Index s) {
  const SectorHeader& header = mesh.sectors[s];
  return {header.shape, mesh.record_wedge_begin[record] + header.wedge,
          std::span(mesh.polygons).subspan(mesh.polygon_begin[s], header.polygon_size),
          mesh.triangles.data() + 3 * mesh.slot_begin(s)};
}

/// Whether the vertex could be collapsed into a corner without the sector's outline changing.
bool is_target(const Sector& sector, std::size_t corner) {
  const std::size_t last = sector.polygon.size() - 1;
  switch (sector.shape) {
    case SectorShape::Closed:
      return true;
    case SectorShape::Moved:
      return corner == last;
    case SectorShape::Open:
    case SectorShape::Lone:
      return corner == 0 || corner == last;
  }
  return false;
}

Index vertex_at(const ProgressiveMesh& mesh, const Sector& sector, std::size_t corner) {
  return mesh.wedge_vertex[sector.polygon[corner]];
}

/// Returns the corner that a vertex has in a sector's polygon; as many as that has for none.
std::size_t corner_at(const ProgressiveMesh& mesh, const Sector& sector, Index vertex) {
  const auto found = std::find_if(sector.polygon.begin(), sector.polygon.end(),
                                  [&](Index wedge) { return mesh.wedge_vertex[wedge] == vertex; });
  return static_cast<std::size_t>(found - sector.polygon.begin());
}

/// What is seen where a vertex begins at a corner.
struct Change {
  std::size_t triangles = 0;  ///< that are others; where a sector has another outline, more than it has
  double volume = 0;          ///< between those and what takes their place, six times that at most
  double way = 0;             ///< to the vertex, squared

  bool operator<(const Change& other) const {
    return std::tie(triangles, volume, way) < std::tie(other.triangles, other.volume, other.way);
  }
};

/// Adds what changes in a sector where the vertex begins at `origin`; `corner`: of that, where it has none the one
/// behind the last.
void add_change(const ProgressiveMesh& mesh, const Sector& sector, std::size_t corner, Index origin, Change& change) {
  const std::size_t count = sector.polygon.size() - 2;
  if (corner >= sector.polygon.size())
    change.triangles += 3 * (count + 1);
  else if (!is_target(sector, corner))
    change.triangles += count + 1;
  const Vec3 apex(mesh.positions[origin]);
  for (const std::uint8_t* t = sector.triangles; t != sector.triangles + 3 * count; t += 3) {
    const Index a = vertex_at(mesh, sector, t[0]), b = vertex_at(mesh, sector, t[1]), c = vertex_at(mesh, sector, t[2]);
    if (a == origin || b == origin || c == origin) continue;
    ++change.triangles;
    change.volume += std::abs(
        dot(cross(Vec3(mesh.positions[a]) - apex, Vec3(mesh.positions[b]) - apex), Vec3(mesh.positions[c]) - apex));
  }
}

/// Returns the corner, as a wedge, that the vertex of a record begins at: where the least is seen to change. It depends
/// on the record alone, so that what a vertex begins as does not depend on the way. Cost: for each corner of the first
/// sector, at most kMostCorners, those of all. Pre: the record has sectors.
Index best_origin(const ProgressiveMesh& mesh, Index record) {
  const Index begin = mesh.sector_begin[record], end = mesh.sector_begin[record + 1];
  const Sector first = sector_of(mesh, record, begin);
  const Vec3 place(mesh.positions[mesh.base_vertex_count + record]);
  const std::size_t last = first.polygon.size() - 1;
  Change least;
  Index best = kNoIndex;
  for (std::size_t corner = 0; corner <= last; ++corner) {
    if (!is_target(first, corner) || (corner >= kMostCorners && corner < last)) continue;
    const Index vertex = vertex_at(mesh, first, corner);
    Change change;
    change.way = squared_length(Vec3(mesh.positions[vertex]) - place);
    add_change(mesh, first, corner, vertex, change);
    for (Index s = begin + 1; s < end; ++s) {
      const Sector sector = sector_of(mesh, record, s);
      add_change(mesh, sector, corner_at(mesh, sector, vertex), vertex, change);
    }
    if (best != kNoIndex && !(change < least)) continue;
    least = change;
    best = first.polygon[corner];
  }
  return best;
}

}  // namespace

Geomorph::Geomorph(const ProgressiveMesh& mesh) : mesh_(&mesh), moved_(1) { set(0, 0); }

void Geomorph::make_room() {
  const std::size_t wedges = mesh_->wedge_vertex.size();
  if (wedges > origins_.capacity()) origins_.reserve(std::max(wedges, origins_.capacity() * 3 / 2));
  if (mesh_->move_begin.empty()) return;
  moved_.make_room(wedges);
  detail::add_created(*mesh_, positions_);
}

void Geomorph::set(Index coarse, Index fine) {
  make_room();
  const auto last = static_cast<Index>(mesh_->record_count());
  fine_ = std::min(fine, last);
  place_coarse(std::min(coarse, fine_));
  mark_moved();
  first_ = mesh_->record_wedge_begin[coarse_];
  origins_.clear();
  for (Index record = coarse_; record < fine_; ++record) find_origins(record);
  for (Index& origin : origins_) origin = root(origin);
}

void Geomorph::place_coarse(Index position) {
  if (!mesh_->move_begin.empty())
    detail::follow_moves(*mesh_, coarse_, position,
                         [this](Index vertex, const Vec3f& place) { positions_[vertex] = place; });
  coarse_ = position;
}

void Geomorph::mark_moved() {
  if (mesh_->move_begin.empty()) return;
  const std::size_t vertices = mesh_->base_vertex_count + std::size_t{coarse_};
  detail::follow_moves(*mesh_, coarse_, fine_, [&](Index vertex, const Vec3f&) {
    if (vertex >= vertices) return;
    const EntryRange wedges = detail::wedges_of(*mesh_, vertex);
    for (std::size_t wedge = wedges.begin; wedge < wedges.end; ++wedge) moved_.mark(wedge);
  });
}

void Geomorph::take_moved_wedges(std::size_t gap, std::vector<EntryRange>& ranges) { moved_.take(first_, gap, ranges); }

/// Returns what a wedge begins as, as far as is known.
Index Geomorph::root(Index wedge) {
  while (wedge >= first_ && origins_[wedge - first_] != wedge) {
    Index& next = origins_[wedge - first_];
    if (next >= first_) next = origins_[next - first_];  // a shorter way for who comes next
    wedge = next;
  }
  return wedge;
}

/// Appends the origins of the wedges that a record adds: themselves where its vertex has no faces yet.
void Geomorph::find_origins(Index record) {
  const Index begin = mesh_->record_wedge_begin[record], end = mesh_->record_wedge_begin[record + 1];
  const Index first_sector = mesh_->sector_begin[record], end_sector = mesh_->sector_begin[record + 1];
  if (first_sector == end_sector) {
    for (Index wedge = begin; wedge < end; ++wedge) origins_.push_back(wedge);
    return;
  }
  const Index best = best_origin(*mesh_, record), origin = root(best);
  origins_.insert(origins_.end(), end - begin, origin);
  for (Index s = end_sector; s-- > first_sector;) {
    const Sector sector = sector_of(*mesh_, record, s);
    const std::size_t corner = corner_at(*mesh_, sector, mesh_->wedge_vertex[best]);
    if (corner < sector.polygon.size()) origins_[sector.wedge - first_] = root(sector.polygon[corner]);
    if (sector.shape == SectorShape::Lone)
      for (const Index wedge : sector.polygon) join_piece(wedge, origin);
  }
}

/// Has a vertex that came without faces begin where others of its piece do, so that nothing is seen of that.
void Geomorph::join_piece(Index wedge, Index origin) {
  const Index own = root(wedge);
  if (own < first_) return;
  const EntryRange wedges = detail::wedges_of(*mesh_, mesh_->wedge_vertex[own]);
  for (std::size_t w = wedges.begin; w < wedges.end; ++w) {
    const Index there = root(static_cast<Index>(w));
    if (there >= first_ && there != origin) origins_[there - first_] = origin;
  }
}

void copy_starts(const Geomorph& morph, EntryRange wedges, float* out) {
  for (std::size_t w = wedges.begin; w < wedges.end; ++w) {
    const Vec3f& p = morph.start(static_cast<Index>(w));
    *out++ = p.x, *out++ = p.y, *out++ = p.z;
  }
}

void copy_starts(const Geomorph& morph, const Attribute& attribute, EntryRange wedges, std::byte* out) {
  const std::size_t each = attribute.element_bytes();
  for (std::size_t w = wedges.begin; w < wedges.end; ++w, out += each)
    std::memcpy(out, attribute.data.data() + each * morph.origin(static_cast<Index>(w)), each);
}

}  // namespace lodestone

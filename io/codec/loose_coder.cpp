#include "codec/loose_coder.h"

#include <algorithm>
#include <bit>

#include <lodestone/lod/progressive_mesh.h>

namespace lodestone::detail {
namespace {

enum Bit : std::uint32_t { kAny, kShapeHigh, kShapeLow, kShapeLow2, kSame, kNew };
enum Number : std::uint32_t { kCounts, kSectorSizes, kBack, kSectors };

}  // namespace

bool trace_polygon(const PatchMesh& mesh, std::span<const Index> faces, Index start, std::vector<Index>& polygon,
                   std::vector<std::array<std::uint8_t, 3>>& triangles) {
  std::vector<std::array<Index, 2>> edges, outer;
  for (const Index face : faces)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) edges.push_back({mesh.wedge(h), mesh.wedge(next_corner(h))});
  for (const auto& edge : edges)
    if (std::find(edges.begin(), edges.end(), std::array{edge[1], edge[0]}) == edges.end()) outer.push_back(edge);
  const std::size_t first = polygon.size();
  if (outer.size() != faces.size() + 2 || start >= outer.size()) return false;
  for (std::size_t at = start;;) {
    if (std::find(polygon.begin() + static_cast<std::ptrdiff_t>(first), polygon.end(), outer[at][0]) != polygon.end())
      return false;
    polygon.push_back(outer[at][0]);
    if (polygon.size() - first == outer.size()) {
      if (outer[at][1] != polygon[first]) return false;
      break;
    }
    const auto next = std::find_if(outer.begin(), outer.end(), [&](const auto& e) { return e[0] == outer[at][1]; });
    if (next == outer.end()) return false;
    at = static_cast<std::size_t>(next - outer.begin());
  }
  const auto ring = std::span(polygon).subspan(first);
  for (const Index face : faces) {
    std::array<std::uint8_t, 3> places{};
    for (Index k = 0; k < 3; ++k) {
      const auto found = std::find(ring.begin(), ring.end(), mesh.wedge(3 * face + k));
      if (found == ring.end()) return false;
      places[k] = static_cast<std::uint8_t>(found - ring.begin());
    }
    std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
    if (!(places[0] < places[1] && places[1] < places[2])) return false;
    triangles.push_back(places);
  }
  return true;
}

std::int64_t LooseCoder::code_number(BitCoder& coder, std::int64_t number, std::uint32_t kind) {
  NumberCoder::Guess guess;
  guess.kind = kind;
  guess.value = 8;
  guess.scale = 32;
  return numbers_.code(coder, number, guess);
}

Index LooseCoder::code_count(BitCoder& coder, Index count) {
  const std::array<std::uint32_t, 1> context = {kAny};
  if (bits_.code(coder, count > 0 ? 1 : 0, context, 0) == 0) return 0;
  return static_cast<Index>(std::clamp<std::int64_t>(code_number(coder, count, kCounts), 0, 1 << 30));
}

bool LooseCoder::code_sector(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges, Index used,
                             LooseRecord::Sector& sector) {
  const auto bit = [&](std::uint32_t context, bool is) {
    return bits_.code(coder, is ? 1U : 0U, std::array<std::uint32_t, 1>{context}, 0) != 0;
  };
  const auto raw = [&](Index& value, std::size_t count) {
    value = coder.code_raw(value, std::bit_width(static_cast<Index>(count) - 1));
    return value < count;
  };
  const auto shape = static_cast<std::uint32_t>(sector.shape);
  const std::uint32_t high = bit(kShapeHigh, shape >= 2) ? 1 : 0;
  const std::uint32_t low = bit(kShapeLow + high, (shape & 1U) != 0) ? 1 : 0;
  sector.shape = static_cast<SectorShape>(2 * high + low);
  if (used == 0 || bit(kNew, sector.centre == used))
    sector.centre = used;
  else if (!raw(sector.centre, used))
    return false;
  std::int64_t size = static_cast<std::int64_t>(sector.coarse.size());
  if (sector.shape != SectorShape::Lone) size = code_number(coder, size, kSectorSizes);
  if (size < 0 || size > static_cast<std::int64_t>(kMostPolygonCorners) - 2) return false;
  if (size == 0 && sector.shape != SectorShape::Lone && sector.shape != SectorShape::Open) return false;
  sector.coarse.resize(static_cast<std::size_t>(size));
  for (Index& face : sector.coarse)
    if (!raw(face, mesh.face_count())) return false;
  if (size > 0) return raw(sector.start, sector.coarse.size() + 2);
  if (!raw(sector.group, group_count_)) return false;
  const auto wedge_count = static_cast<std::int64_t>(wedges.size());
  for (Index& wedge : sector.polygon) {
    const std::int64_t back = code_number(coder, wedge_count - 1 - std::int64_t{wedge}, kBack);
    if (back < 0 || back >= wedge_count) return false;
    wedge = static_cast<Index>(wedge_count - 1 - back);
    if (wedges.vertex(wedge) + 1 == wedges.vertex_count()) return false;  // of the vertex itself
  }
  return true;
}

/// Adds a sector by its polygon; its faces are yet to be written.
bool LooseCoder::add_sector(const LooseRecord::Sector& sector, const PatchMesh& mesh, const WedgeTable& wedges,
                            SectorList& sectors) {
  Index group = sector.group;
  if (sector.coarse.empty()) {
    sectors.polygons.insert(sectors.polygons.end(), sector.polygon.begin(), sector.polygon.end());
  } else {
    group = mesh.group(sector.coarse.front());
    for (const Index face : sector.coarse)
      if (mesh.group(face) != group) return false;
    if (!trace_polygon(mesh, sector.coarse, sector.start, sectors.polygons, sectors.triangles)) return false;
    sectors.coarse.insert(sectors.coarse.end(), sector.coarse.begin(), sector.coarse.end());
  }
  sectors.end_sector(sector.shape, group, wedges.begin(static_cast<Index>(wedges.vertex_count() - 1)) + sector.centre);
  return true;
}

/// Writes the faces of the sectors from one on.
bool LooseCoder::place(std::size_t first_sector, std::uint32_t round, PatchMesh& mesh, const WedgeTable& wedges,
                       SectorList& sectors) {
  const auto vertex = static_cast<Index>(wedges.vertex_count() - 1);
  faces_.clear();
  for (std::size_t s = first_sector; s < sectors.sectors.size(); ++s)
    for (const Index face : sectors.coarse_of(s)) faces_.push_back(face);
  std::sort(faces_.begin(), faces_.end());
  if (std::adjacent_find(faces_.begin(), faces_.end()) != faces_.end()) return false;
  freed_.clear();
  for (const Index face : faces_)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index other = mesh.part(h);
      if (other != kNoIndex && !std::binary_search(faces_.begin(), faces_.end(), face_of_corner(other)))
        freed_.push_back(other);
    }
  const std::size_t first_fine = sectors.fine.size();
  for (std::size_t s = first_sector; s < sectors.sectors.size(); ++s) {
    SectorList::Sector& sector = sectors.sectors[s];
    const std::span<const Index> polygon = sectors.polygon(s), coarse = sectors.coarse_of(s);
    const auto appended = static_cast<std::size_t>(appended_face_count(sector.shape));
    for (std::size_t i = 0; i < coarse.size() + appended; ++i) {
      const Index from = polygon[i], to = polygon[(i + 1) % polygon.size()];
      const Index face = i < coarse.size() ? coarse[i] : static_cast<Index>(mesh.face_count());
      mesh.write_face(face, {vertex, wedges.vertex(from), wedges.vertex(to)}, {sector.wedge, from, to}, sector.group,
                      round);
      sectors.fine.push_back(face);
    }
    sector.fine_end = static_cast<Index>(sectors.fine.size());
  }
  join(std::span(sectors.fine).subspan(first_fine), mesh);
  return true;
}

void LooseCoder::join(std::span<const Index> fine, PatchMesh& mesh) {
  for (const Index face : fine)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) freed_.push_back(h);
  const std::size_t own = freed_.size();
  for (std::size_t i = 0; i < own; ++i) {
    const auto found = borders_.find(ends_key(mesh.to(freed_[i]), mesh.from(freed_[i])));
    if (found == borders_.end() || mesh.twin(found->second) != kNoIndex) continue;
    const Index half = found->second;
    if (mesh.from(half) == mesh.to(freed_[i]) && mesh.to(half) == mesh.from(freed_[i])) freed_.push_back(half);
  }
  std::sort(freed_.begin(), freed_.end());
  freed_.erase(std::unique(freed_.begin(), freed_.end()), freed_.end());
  mesh.join(freed_);
  for (const Index face : fine)
    for (Index h = 3 * face; h < 3 * face + 3; ++h)
      if (mesh.twin(h) == kNoIndex) borders_[ends_key(mesh.from(h), mesh.to(h))] = h;
}

bool LooseCoder::code(BitCoder& coder, LooseRecord& record, std::uint32_t round, std::uint64_t most_corners,
                      PatchMesh& mesh, WedgeTable& wedges, SectorList& sectors) {
  const auto count = code_number(coder, static_cast<std::int64_t>(record.sectors.size()), kSectors);
  if (count < 0 || count > static_cast<std::int64_t>(kMostLooseSectors)) return false;
  record.sectors.resize(static_cast<std::size_t>(count));
  const auto vertex = static_cast<Index>(wedges.vertex_count() - 1);
  const std::size_t first_sector = sectors.sectors.size(), first_corner = sectors.polygons.size();
  for (LooseRecord::Sector& sector : record.sectors) {
    const Index used = wedges.count(vertex);
    if (!code_sector(coder, mesh, wedges, used, sector)) return false;
    if (sector.centre == used) wedges.add_wedge();
    if (!add_sector(sector, mesh, wedges, sectors)) return false;
    if (sectors.polygons.size() - first_corner > most_corners) return false;
  }
  return place(first_sector, round, mesh, wedges, sectors);
}

}  // namespace lodestone::detail

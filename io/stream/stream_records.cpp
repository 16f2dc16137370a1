#include "stream/stream_records.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include <lodestone/core/detail/edges.h>

#include "base/bytes.h"

// What is left of a record once it is predicted. A vertex is expected in the middle of the polygon of its hole, as in
// P. Alliez, M. Desbrun: Progressive compression for lossless transmission of triangle meshes (SIGGRAPH 2001);
// residuals are differences of the bits of floats in their order, so that they are exact, as in M. Isenburg, P.
// Lindstrom, J. Snoeyink: Lossless compression of predicted floating-point geometry (Computer-Aided Design 37, 2005).
// Nothing is quantised.

namespace lodestone::detail {
namespace {

Coding planes_of(ComponentType type) { return static_cast<Coding>(component_bytes(type)); }

void add_value_columns(std::vector<Column>& columns, std::span<const Attribute> attributes) {
  columns.insert(columns.end(), 3, Column{Coding::Planes4, {}});
  for (const Attribute& a : attributes) columns.insert(columns.end(), a.component_count, Column{planes_of(a.type), {}});
}

}  // namespace

std::vector<Column> record_columns(std::span<const Attribute> attributes) {
  std::vector<Column> columns(kPositions);
  for (const RecordColumn wide : {kFirstSlots, kOtherSlots, kLooseWedges, kDeviations, kCurvatures})
    columns[wide].coding = Coding::Planes4;
  for (const RecordColumn narrow : {kTriangles, kRotations}) columns[narrow].coding = Coding::Planes1;
  add_value_columns(columns, attributes);
  return columns;
}

std::vector<Column> base_columns(std::span<const Attribute> attributes) {
  std::vector<Column> columns(kBasePositions);
  columns[kBaseCorners].coding = Coding::Planes4;
  add_value_columns(columns, attributes);
  return columns;
}

OrderedComponents::OrderedComponents(ComponentType type)
    : type_(type), width_(static_cast<unsigned>(8 * component_bytes(type))) {}

std::uint32_t OrderedComponents::load(std::span<const std::byte> component) const {
  switch (type_) {
    case ComponentType::Int8:
      return detail::load<std::uint8_t>(component, 0) ^ 0x80u;
    case ComponentType::UInt8:
      return detail::load<std::uint8_t>(component, 0);
    case ComponentType::Int16:
      return detail::load<std::uint16_t>(component, 0) ^ 0x8000u;
    case ComponentType::UInt16:
      return detail::load<std::uint16_t>(component, 0);
    case ComponentType::UInt32:
      return detail::load<std::uint32_t>(component, 0);
    case ComponentType::Float32:
      return ordered_bits(detail::load<float>(component, 0));
  }
  return 0;
}

void OrderedComponents::store(std::uint32_t ordered, std::span<std::byte> component) const {
  if (type_ == ComponentType::Float32) ordered = std::bit_cast<std::uint32_t>(from_ordered_bits(ordered));
  if (type_ == ComponentType::Int8) ordered ^= 0x80u;
  if (type_ == ComponentType::Int16) ordered ^= 0x8000u;
  std::memcpy(component.data(), &ordered, width_ / 8);  // little-endian: the low bytes come first
}

std::uint32_t OrderedComponents::residual(std::uint32_t value, std::uint32_t prediction) const {
  // The difference is moved to the top so that its sign is that of 32 bits, and back after zigzag.
  const unsigned unused = 32 - width_;
  return zigzag(static_cast<std::uint32_t>(static_cast<std::int32_t>((value - prediction) << unused) >> unused));
}

std::uint32_t OrderedComponents::restore(std::uint32_t residual, std::uint32_t prediction) const {
  const std::uint32_t mask = width_ == 32 ? ~0u : (1u << width_) - 1;
  return (prediction + unzigzag(residual)) & mask;
}

std::array<std::uint32_t, 3> predict_position(const ProgressiveMesh& mesh, std::size_t record) {
  std::array<Mean, 3> means;
  for_each_ring_corner(mesh, record, kAllWedges, [&](Index wedge) {
    const Vec3f& p = mesh.positions[mesh.wedge_vertex[wedge]];
    means[0].add(ordered_bits(p.x));
    means[1].add(ordered_bits(p.y));
    means[2].add(ordered_bits(p.z));
  });
  const std::size_t vertex = mesh.base_vertex_count + record;
  const Vec3f before = vertex > 0 ? mesh.positions[vertex - 1] : Vec3f{};
  return {means[0].value_or(ordered_bits(before.x)), means[1].value_or(ordered_bits(before.y)),
          means[2].value_or(ordered_bits(before.z))};
}

std::uint32_t predict_component(const ProgressiveMesh& mesh, std::size_t record, int wedge, const Attribute& attribute,
                                const OrderedComponents& components, std::size_t component) {
  Mean mean;
  const std::size_t size = component_bytes(attribute.type);
  for_each_ring_corner(mesh, record, wedge, [&](Index ring_wedge) {
    const std::size_t at = ring_wedge * attribute.element_bytes() + component * size;
    mean.add(components.load(std::span(attribute.data).subspan(at, size)));
  });
  return mean.value_or(0);
}

namespace {

/// Returns, for each corner, the face across its edge. An edge that several faces of broken data have belongs to the
/// last of them, here as in any other decoder.
std::vector<Index> find_neighbours(std::span<const Index> corners) {
  const std::vector<HalfEdge> halves = sorted_edges(corners);
  std::vector<Index> neighbours(corners.size(), kNoIndex);
  for_each_edge(halves, [&](Edge edge) {
    std::array<Index, 2> last{kNoIndex, kNoIndex};  // by whether it is forward
    for (const HalfEdge& half : edge) last[half.forward ? 1 : 0] = face_of_corner(half.corner);
    if (edge[0].is_loop()) last[1] = last[0];  // its own reverse
    for (const HalfEdge& half : edge) neighbours[half.corner] = last[half.forward ? 0 : 1];
  });
  return neighbours;
}

}  // namespace

FaceReplay::FaceReplay(const std::vector<FaceGroup>& groups) {
  for (const FaceGroup& group : groups) groups_.push_back({group.base_corners, find_neighbours(group.base_corners)});
}

void FaceReplay::refine(const ProgressiveMesh& mesh, std::size_t record) {
  for (Index s = mesh.sector_begin[record]; s < mesh.sector_begin[record + 1]; ++s) {
    Group& group = groups_[mesh.sectors[s].group];
    find_outer(mesh, s, group);
    place_fine_faces(mesh, record, s, group);
  }
}

/// Finds the faces across the polygon's edges, which the coarse faces inside know.
void FaceReplay::find_outer(const ProgressiveMesh& mesh, Index sector, const Group& group) {
  const std::size_t size = mesh.sectors[sector].polygon_size;
  const Index* polygon = mesh.polygons.data() + mesh.polygon_begin[sector];
  outer_.assign(size, kNoIndex);
  for (std::uint64_t i = mesh.slot_begin(sector); i < mesh.slot_begin(sector + 1); ++i) {
    const std::uint8_t* triangle = mesh.triangles.data() + 3 * i;
    const std::size_t face = 3 * std::size_t{mesh.slots[i]};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = triangle[k], to = triangle[(k + 1) % 3];
      if (to != (from + 1) % size) continue;  // a diagonal
      for (std::size_t edge = 0; edge < 3; ++edge)
        if (group.corners[face + edge] == polygon[from]) outer_[from] = group.neighbours[face + edge];
    }
  }
}

/// Writes the fine faces and ties them to each other and to the faces across the polygon's edges. What meets at the two
/// ends of a sector that is not the whole ring stays unknown.
void FaceReplay::place_fine_faces(const ProgressiveMesh& mesh, std::size_t record, Index s, Group& group) {
  const SectorHeader& sector = mesh.sectors[s];
  const Index* polygon = mesh.polygons.data() + mesh.polygon_begin[s];
  const Index* slots = mesh.slots.data() + mesh.slot_begin(s);
  const Index centre = mesh.record_wedge_begin[record] + sector.wedge;
  const std::size_t size = sector.polygon_size;
  const std::size_t fine_count = size - 2 + static_cast<std::size_t>(appended_face_count(sector.shape));
  const bool is_ring = sector.shape == SectorShape::Closed;

  fine_.assign(slots, slots + (size - 2));
  for (std::size_t i = size - 2; i < fine_count; ++i)
    fine_.push_back(static_cast<Index>(group.corners.size() / 3 + i - (size - 2)));
  group.corners.resize(group.corners.size() + 3 * (fine_count - (size - 2)));
  group.neighbours.resize(group.corners.size(), kNoIndex);
  for (std::size_t i = 0; i < fine_count; ++i) {
    const bool first = !is_ring && i == 0, last = !is_ring && i + 1 == fine_count;
    const std::array<Index, 3> face = {centre, polygon[i], polygon[(i + 1) % size]};  // the newest wedge comes first
    const std::array<Index, 3> across = {first ? kNoIndex : fine_[(i + fine_count - 1) % fine_count], outer_[i],
                                         last ? kNoIndex : fine_[(i + 1) % fine_count]};
    std::copy(face.begin(), face.end(), group.corners.begin() + 3 * std::size_t{fine_[i]});
    std::copy(across.begin(), across.end(), group.neighbours.begin() + 3 * std::size_t{fine_[i]});
    if (outer_[i] == kNoIndex) continue;
    const std::size_t outer = 3 * std::size_t{outer_[i]};
    for (std::size_t edge = 0; edge < 3; ++edge)
      if (group.corners[outer + edge] == face[2] && group.corners[outer + (edge + 1) % 3] == face[1])
        group.neighbours[outer + edge] = fine_[i];
  }
}

void PolygonTracer::begin(std::size_t polygon_size) {
  wedges_.assign(polygon_size, kNoIndex);
  open_edges_.clear();
}

Index PolygonTracer::expected_slot(std::span<const std::uint8_t, 3> triangle) const {
  for (std::size_t k = 0; k < 3; ++k)
    for (const OpenEdge& edge : open_edges_)
      if (edge.from == triangle[k] && edge.to == triangle[(k + 1) % 3]) return edge.slot;
  return kNoIndex;
}

int PolygonTracer::rotation_of(std::span<const std::uint8_t, 3> triangle, std::span<const Index, 3> face) const {
  for (std::size_t i = 0; i < 3; ++i) {
    const Index known = wedges_[triangle[i]];
    if (known == kNoIndex) continue;
    for (int rotation = 0; rotation < 3; ++rotation)
      if (face[(i + static_cast<std::size_t>(rotation)) % 3] == known) return rotation;
    return kMismatch;
  }
  return kFree;
}

bool PolygonTracer::trace(std::span<const std::uint8_t, 3> triangle, const FaceReplay& faces, std::size_t group,
                          Index slot, int rotation) {
  const auto face = faces.face(group, slot);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t corner = (i + static_cast<std::size_t>(rotation)) % 3;
    Index& wedge = wedges_[triangle[i]];
    if (wedge != kNoIndex && wedge != face[corner]) return false;
    wedge = face[corner];
    open_edges_.push_back({triangle[(i + 1) % 3], triangle[i], faces.neighbour(group, slot, corner)});
  }
  return true;
}

}  // namespace lodestone::detail

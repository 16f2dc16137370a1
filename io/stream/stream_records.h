#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/progressive_mesh.h>

#include "base/ordered_bits.h"
#include "stream/stream_columns.h"

// What encoder and decoder of the removal stream have in common: the columns of a chunk, the predictions, and the index
// buffers of the level that the records so far lead to.

namespace lodestone::detail {

/// The columns of a record chunk, in file order. Three columns of positions and the attributes' follow them.
enum RecordColumn : std::size_t {
  kRoundSizes,    ///< per round: records
  kWedgeCounts,   ///< per record: new wedges
  kSectorCounts,  ///< per record
  kPolygonSizes,  ///< per sector
  kGroups,        ///< per sector
  kCentres,       ///< per sector: 4·wedge + shape; in version 1: 2·wedge + closed
  kFirstSlots,    ///< per sector with slots
  kOtherSlots,    ///< per further slot: 0 where it is the expected one, else slot + 1
  kTriangles,     ///< three per slot
  kRotations,     ///< per slot whose triangle shares no corner with those before it in its sector
  kLooseWedges,   ///< per polygon corner that no triangle has
  kDeviations,    ///< per record: zigzag of the difference of ordered bits
  kCurvatures,    ///< the same
  kPositions,     ///< three columns: zigzag of the residual of ordered bits
  kFirstAttribute = kPositions + 3,
};

/// The columns of the base chunk, in file order. Three columns of positions and the attributes' follow them.
enum BaseColumn : std::size_t {
  kGroupTable,      ///< per group: material, base faces
  kAttributeTable,  ///< per attribute: name length, name, component type, component count, normalized
  kWedgeVertices,   ///< per wedge: zigzag of the difference to the one before
  kBaseCorners,     ///< per corner, group by group: zigzag of the difference to the one before
  kBasePositions,
  kFirstBaseAttribute = kBasePositions + 3,
};

/// Returns the columns of a chunk, empty. Those of attributes: one per component, in the order of the attributes.
std::vector<Column> record_columns(std::span<const Attribute> attributes);
std::vector<Column> base_columns(std::span<const Attribute> attributes);

/// The components of an attribute as unsigned numbers in the order of their values.
class OrderedComponents {
 public:
  explicit OrderedComponents(ComponentType type);
  std::uint32_t load(std::span<const std::byte> component) const;
  void store(std::uint32_t ordered, std::span<std::byte> component) const;
  /// Residuals wrap around at the component's width.
  std::uint32_t residual(std::uint32_t value, std::uint32_t prediction) const;
  std::uint32_t restore(std::uint32_t residual, std::uint32_t prediction) const;

 private:
  ComponentType type_;
  unsigned width_;  ///< bits
};

/// A mean of unsigned numbers, rounded down; `fallback` where there are none.
class Mean {
 public:
  void add(std::uint32_t value) {
    sum_ += value;
    ++count_;
  }
  std::uint32_t value_or(std::uint32_t fallback) const {
    return count_ == 0 ? fallback : static_cast<std::uint32_t>(sum_ / count_);
  }

 private:
  std::uint64_t sum_ = 0;
  std::uint64_t count_ = 0;
};

/// Calls `visit(i)` with the index in `polygons` of every polygon corner of a record, or only of the sectors around its
/// new wedge number `wedge`.
inline constexpr int kAllWedges = -1;
template <class Visit>
void for_each_ring_corner(const ProgressiveMesh& mesh, std::size_t record, int wedge, const Visit& visit) {
  for (Index s = mesh.sector_begin[record]; s < mesh.sector_begin[record + 1]; ++s)
    if (wedge == kAllWedges || mesh.sectors[s].wedge == wedge)
      for (std::uint64_t i = mesh.polygon_begin[s]; i < mesh.polygon_begin[s + 1]; ++i) visit(mesh.polygons[i]);
}

/// Predicts the position of a record's vertex: component-wise the mean of its ring's ordered bits, else the vertex
/// before it. Pre: the record's polygons name existing wedges.
std::array<std::uint32_t, 3> predict_position(const ProgressiveMesh& mesh, std::size_t record);

/// Predicts a component of a record's new wedge number `wedge` from the polygons around it, else 0.
std::uint32_t predict_component(const ProgressiveMesh& mesh, std::size_t record, int wedge, const Attribute& attribute,
                                const OrderedComponents& components, std::size_t component);

/// The index buffers of the level after the records so far, and which faces of a group meet at an edge.
class FaceReplay {
 public:
  explicit FaceReplay(const std::vector<FaceGroup>& groups);

  std::size_t face_count(std::size_t group) const { return groups_[group].corners.size() / 3; }
  /// Returns a face's three wedges, largest first.
  std::span<const Index, 3> face(std::size_t group, Index slot) const {
    return std::span<const Index, 3>(groups_[group].corners.data() + 3 * std::size_t{slot}, 3);
  }
  /// Returns the face of the group that has edge `edge` of a face (from corner `edge` to the next) the other way
  /// round, or kNoIndex where there is none or it is not known.
  Index neighbour(std::size_t group, Index slot, std::size_t edge) const {
    return groups_[group].neighbours[3 * std::size_t{slot} + edge];
  }
  /// Applies a record. Pre: its sectors' groups and slots exist, and their faces have the corners the polygon says.
  void refine(const ProgressiveMesh& mesh, std::size_t record);

 private:
  struct Group {
    std::vector<Index> corners;
    std::vector<Index> neighbours;  ///< one per corner: across the edge that begins there
  };

  void find_outer(const ProgressiveMesh& mesh, Index sector, const Group& group);
  void place_fine_faces(const ProgressiveMesh& mesh, std::size_t record, Index sector, Group& group);

  std::vector<Group> groups_;
  std::vector<Index> outer_;  ///< of the sector at hand: the face across each polygon edge
  std::vector<Index> fine_;   ///< of the sector at hand: the slots of its fine faces
};

/// Reads a polygon off the coarse faces that cover it. Triangles come one by one; what is known of those before tells
/// most of the next: two of its corners, so how its face is rotated, and which face lies across the shared edge.
class PolygonTracer {
 public:
  static constexpr int kFree = 3;       ///< a rotation nothing is known of
  static constexpr int kMismatch = -1;  ///< a face that does not have the corners traced before

  /// Begins a sector of so many corners.
  void begin(std::size_t polygon_size);

  /// Returns the face expected for a triangle: the one across the first edge it shares with an earlier triangle, in
  /// the order of its edges ab, bc, ca and of the triangles; kNoIndex where there is none.
  Index expected_slot(std::span<const std::uint8_t, 3> triangle) const;

  /// Returns how a face lies in its triangle: corner i of the triangle is corner (i + rotation) mod 3 of the face.
  int rotation_of(std::span<const std::uint8_t, 3> triangle, std::span<const Index, 3> face) const;

  /// Notes a triangle's corners and the faces across its edges; false if that contradicts a corner traced before.
  bool trace(std::span<const std::uint8_t, 3> triangle, const FaceReplay& faces, std::size_t group, Index slot,
             int rotation);

  /// The wedges traced; kNoIndex where no triangle has a corner.
  std::span<const Index> wedges() const { return wedges_; }

 private:
  struct OpenEdge {
    std::uint8_t from, to;  ///< as the triangle across has it
    Index slot;
  };
  std::vector<Index> wedges_;
  std::vector<OpenEdge> open_edges_;
};

}  // namespace lodestone::detail

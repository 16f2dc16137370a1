#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone {

struct RemovalRecord;

/// What a vertex is, by the constrained edges that meet at it. Constrained are borders, seams (the wedges differ on the
/// two sides), material borders and creases.
enum class VertexKind : std::uint8_t {
  Interior,     ///< closed ring, no constrained edge
  Border,       ///< open ring, no constrained edge but its two border edges
  Feature,      ///< closed ring, exactly two constrained edges: a feature line passes through
  Corner,       ///< any other number of constrained edges
  NonManifold,  ///< one of several copies of a vertex that was cut into sheets, to be removed together
  Isolated,     ///< no face uses it
};

/// The faces around one vertex, counter-clockwise, and where constrained edges cut them into sectors.
///
/// `corners[i]` is face i's corner at the vertex. In an open ring face 0 follows the border. Where there are
/// constrained edges inside, face 0 follows one of them. `sector_begin` holds the first face of each sector: {0}
/// without constrained edges inside.
struct Star {
  std::vector<Index> corners;
  std::vector<Index> sector_begin;
  bool closed = false;

  std::size_t sector_count() const { return sector_begin.size(); }
  Index sector_end(std::size_t sector) const {
    return sector + 1 < sector_begin.size() ? sector_begin[sector + 1] : static_cast<Index>(corners.size());
  }
  /// Whether the ring closes without meeting a constrained edge.
  bool is_plain() const { return closed && sector_begin.size() == 1 && !starts_constrained; }
  bool starts_constrained = false;  ///< the spoke before face 0 is constrained (always so in an open ring)
};

/// A mutable triangle mesh: a corner table over the wedges of a `Mesh`, with the star of every vertex at hand.
///
/// opposite(c) is the corner across the edge that faces corner c, kNoIndex at a border. A removed face's corners hold
/// kNoIndex. Positions and attributes stay in the `Mesh`. Only `remove_vertex` and `restore_vertex` change it.
class Connectivity {
 public:
  /// Errors: InvalidArgument where a vertex has more than one fan of faces or a face repeats a vertex, naming it.
  static Result<Connectivity> build(const Mesh& mesh);

  std::size_t face_slot_count() const { return corner_wedge_.size() / 3; }
  std::size_t vertex_count() const { return vertex_corner_.size(); }
  std::size_t face_count() const { return face_count_; }

  bool has_face(Index face) const { return corner_wedge_[3 * std::size_t{face}] != kNoIndex; }
  bool has_vertex(Index vertex) const { return vertex_corner_[vertex] != kNoIndex; }
  Index wedge(Index corner) const { return corner_wedge_[corner]; }
  Index vertex(Index corner) const { return (*wedge_vertex_)[corner_wedge_[corner]]; }
  Index vertex_of_wedge(Index wedge) const { return (*wedge_vertex_)[wedge]; }
  Index opposite(Index corner) const { return opposite_[corner]; }
  /// A corner at the vertex: at a border the first counter-clockwise; kNoIndex where no face uses the vertex.
  Index corner_at(Index vertex) const { return vertex_corner_[vertex]; }
  Index material(Index face) const { return face_material_->empty() ? 0 : (*face_material_)[face]; }

  /// The next corner at the same vertex, counter-clockwise; kNoIndex at a border.
  Index swing_left(Index corner) const {
    const Index across = opposite_[next_corner(corner)];
    return across == kNoIndex ? kNoIndex : next_corner(across);
  }
  /// The next corner at the same vertex, clockwise; kNoIndex at a border.
  Index swing_right(Index corner) const {
    const Index across = opposite_[previous_corner(corner)];
    return across == kNoIndex ? kNoIndex : previous_corner(across);
  }

  /// Whether the edge facing `corner` is a border, seam, material border or crease.
  bool is_constrained(Index corner) const;
  /// Marks the edge facing `corner`, on both sides, as a crease: a hard edge that removals keep.
  void mark_crease(Index corner);
  bool is_crease(Index corner) const { return !crease_.empty() && crease_[corner] != 0; }

  /// Fills `star` with the faces around `vertex`; pre: has_vertex(vertex).
  void gather_star(Index vertex, Star& star) const;
  /// The next of the vertex's copies: those at the same position, in a circle. Itself where it is the only one.
  Index next_copy(Index vertex) const { return next_copy_.empty() ? vertex : next_copy_[vertex]; }
  bool is_copy(Index vertex) const { return next_copy(vertex) != vertex; }
  /// The first of the vertex's copies: what stands for the position.
  Index site(Index vertex) const { return site_.empty() ? vertex : site_[vertex]; }

  VertexKind kind(Index vertex) const;
  VertexKind kind(Index vertex, const Star& star) const;
  /// Whether an edge joins the two vertices.
  bool has_edge(Index a, Index b) const;

  const std::vector<Index>& corner_wedges() const { return corner_wedge_; }
  friend bool operator==(const Connectivity&, const Connectivity&) = default;

 private:
  friend void remove_vertex(Connectivity&, RemovalRecord&);
  friend void restore_vertex(Connectivity&, const RemovalRecord&);
  friend struct PatchAccess;

  Result<void> join_faces(const Mesh& mesh);
  Result<void> anchor_vertices();
  void link_copies(const Mesh& mesh);
  Index first_corner(Index corner) const;

  std::vector<Index> corner_wedge_;
  std::vector<Index> opposite_;
  std::vector<Index> vertex_corner_;
  std::vector<Index> next_copy_;      // per vertex, empty where there are no copies
  std::vector<Index> site_;           // the same
  std::vector<std::uint8_t> crease_;  // per corner, empty where there are none
  const std::vector<Index>* wedge_vertex_ = nullptr;
  const std::vector<Index>* face_material_ = nullptr;
  std::size_t face_count_ = 0;
};

}  // namespace lodestone

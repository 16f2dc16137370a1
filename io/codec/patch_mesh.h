#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// What a table of half-edges finds them by.
constexpr std::uint64_t ends_key(Index from, Index to) { return std::uint64_t{from} << 32U | to; }

/// The faces of a level while rounds are coded, and what lies across their edges: neighbours by vertices, so that seams
/// and the borders of groups do not cut the mesh. Half-edge 3f + i runs from corner i of face f to the next corner.
class PatchMesh {
 public:
  std::size_t face_count() const { return face_count_; }
  std::size_t vertex_count() const { return degree_.size(); }
  Index from(Index half) const { return halves_[half].from; }
  Index to(Index half) const { return from(next_corner(half)); }
  Index apex(Index half) const { return from(previous_corner(half)); }
  /// The half-edge the other way round, or kNoIndex at a border.
  Index twin(Index half) const { return halves_[half].twin; }
  /// How many faces a vertex has.
  Index degree(Index vertex) const { return degree_[vertex]; }
  /// In which round a face was made last.
  std::uint32_t made_in(Index face) const { return faces_[face].made_in; }
  /// 16 · log2 of an edge's length, squared, as it was set last; of the outer edges of stars that of the edges there.
  int edge_log(Index half) const { return edge_logs_[half]; }
  /// Sets it on both sides.
  void set_edge_log(Index half, int log) {
    edge_logs_[half] = static_cast<std::int16_t>(log);
    if (twin(half) != kNoIndex) edge_logs_[twin(half)] = edge_logs_[half];
  }
  /// Calls `visit(half)` for the half-edges that leave a vertex, of the faces that hang together with that of one of
  /// them. False where the vertex has more faces.
  template <class Visit>
  bool visit_faces(Index half, const Visit& visit) const {
    const Index count = degree(from(half));
    Index found = 0, at = half;
    do {
      visit(at);
      ++found;
      at = twin(previous_corner(at));
    } while (at != half && at != kNoIndex && found < count);
    if (at == kNoIndex)
      for (at = twin(half); at != kNoIndex && found < count; at = twin(at), ++found) visit(at = next_corner(at));
    return found == count;
  }
  Index wedge(Index corner) const { return wedges_[corner]; }
  Index group(Index face) const { return faces_[face].group; }
  /// Whether wedges or groups differ on the sides of an edge; not at borders.
  bool is_seam(Index half) const {
    const Index other = twin(half);
    return other != kNoIndex && !fit(half, other);
  }

  /// Starts with base faces. Of the half-edges between two vertices those are twins that run in opposite directions
  /// between the same wedges in the same group, and then what is left, where that is one of each direction.
  void start(std::span<const Index> corners, std::span<const Index> wedges, std::span<const Index> groups,
             std::size_t vertex_count);

  /// Makes room for so many more faces: faster than face by face.
  void reserve(std::size_t more);
  /// Replaces a patch by a star of a vertex, which is the next one or one that is there: `polygon` is its outer
  /// half-edges in order; those of an open patch begin behind the closing edge, which is not among them. `faces`: its
  /// faces, as many as the star needs are appended. The star's faces are added to `stars`, the vertex first in each;
  /// they have the wedges and groups of the faces that had their outer edges, and no wedge at the vertex.
  void refine(std::span<const Index> polygon, std::span<const Index> faces, bool closed, Index vertex,
              std::uint32_t round, std::vector<Index>& stars);
  /// Puts a face with a vertex onto a border half-edge, with the wedges and the group of the face there.
  void add_ear(Index half, Index vertex, std::uint32_t round, std::vector<Index>& stars);

  void set_wedge(Index corner, Index wedge) { wedges_[corner] = wedge; }
  void set_group(Index face, Index group) { faces_[face].group = group; }

  /// A vertex without faces.
  void add_vertex() { degree_.push_back(0); }
  /// Writes faces that need not fit to what is there; `face_count()` appends one. Their edges are borders until
  /// `join` has been called.
  void write_face(Index face, const std::array<Index, 3>& vertices, const std::array<Index, 3>& wedges, Index group,
                  std::uint32_t round);
  /// Makes an edge a border on both sides; returns what was its twin.
  Index part(Index half);
  /// Finds twins among border half-edges, as `start` does.
  void join(std::span<const Index> halves);
  /// How often that was done: faces that were not made anew may have got other neighbours by it.
  std::uint32_t join_count() const { return join_count_; }

 private:
  // What is looked at together stands together.
  struct Half {
    Index from, twin;
  };
  struct Face {
    Index group;
    std::uint32_t made_in;
  };
  struct Outer {
    Index from, to, twin, from_wedge, to_wedge, group;
    std::int16_t log;
  };
  void place_star(bool closed, std::span<const Index> faces, Index vertex, std::uint32_t round,
                  std::vector<Index>& stars);
  /// Whether two half-edges in opposite directions have the same wedges and group.
  bool fit(Index half, Index other) const {
    return wedge(half) == wedge(next_corner(other)) && wedge(next_corner(half)) == wedge(other) &&
           group(face_of_corner(half)) == group(face_of_corner(other));
  }

  // There may be room for more faces than there are.
  std::size_t face_count_ = 0;
  std::vector<Half> halves_;
  std::vector<Index> wedges_;  // by corner
  std::vector<std::int16_t> edge_logs_;
  std::vector<Face> faces_;
  std::vector<Index> degree_;
  std::uint32_t join_count_ = 0;
  std::vector<Outer> outer_;
};

}  // namespace lodestone::detail

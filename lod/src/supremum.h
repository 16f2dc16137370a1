#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/deviation.h>

namespace lodestone::detail {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// How far a supremum has to be narrowed, and the largest distance found so far on the way.
struct Goal {
  double relative_tolerance = 0;
  double absolute_tolerance = 0;
  double enough = 0;
  double found = 0;  ///< a distance that some point really has

  /// Upper bounds at or below this need no narrowing.
  double threshold() const { return std::max(enough, found * (1 + relative_tolerance) + absolute_tolerance); }
};

/// Returns the goal that the options ask for, with nothing found.
Goal goal_of(const DeviationOptions& options, const Mesh& a, const Mesh& b, double enough);

/// A point of one surface and what is known of its distance to the other.
struct Anchor {
  double distance = kUnbounded;  ///< an upper bound; to `face` precisely, where there is one
  Index face = kNoIndex;         ///< a face of the other surface at that distance
  bool exact = false;            ///< that face is the nearest
};

/// What is known of a surface's distances to another one. It may be kept, while it stays true, between searches.
struct SurfaceBounds {
  std::vector<Anchor> vertices;  ///< one per vertex
  std::vector<double> faces;     ///< one per face: an upper bound of its points' distances

  explicit SurfaceBounds(const Mesh& mesh) : vertices(mesh.vertex_count()), faces(mesh.face_count(), kUnbounded) {}
  SurfaceBounds() = default;
  double maximum() const { return faces.empty() ? 0 : *std::max_element(faces.begin(), faces.end()); }
};

/// A corner of a piece of a triangle.
struct PieceCorner {
  Vec3 point;
  double distance = kUnbounded;  ///< as in Anchor
  Index face = kNoIndex;         ///< as in Anchor
};

/// Returns an upper bound of the distances from a triangle to a surface, given what its corners know; the search for a
/// better one ends at `target`.
double bound_piece(const std::array<PieceCorner, 3>& corners, const SurfaceIndex& to, double target);

/// The search for the largest distance from the faces of a mesh to a surface: branch and bound, best first.
class SupremumSearch {
 public:
  /// All arguments outlive the search. Pre: `bounds` has the mesh's counts, `to` is not empty.
  SupremumSearch(const Mesh& from, const SurfaceIndex& to, SurfaceBounds& bounds);

  /// Lowers the faces' bounds as far as the goal asks and queries at vertices can.
  void visit_vertices(Goal& goal);
  /// Splits faces until all bounds meet the goal or `budget` queries are spent.
  void split_faces(Goal& goal, std::size_t budget);

  /// Starts from a point of the mesh that is likely far away.
  void probe(const Vec3& point, Goal& goal) { query(point, kNoIndex, kNoIndex, goal); }
  /// Starts from a distance that a point of `face` is known to have.
  void assume(Index face, double distance, Goal& goal);

  double largest_distance() const { return largest_distance_; }
  Vec3 farthest_point() const { return farthest_point_; }  ///< pre: largest_distance() > 0, not by `assume`
  Index farthest_face() const { return farthest_face_; }   ///< kNoIndex where the point was only probed

  /// What is proved, as a result with mean and rms 0.
  OneSidedDeviation result() const;

 private:
  struct Piece {
    double bound;
    std::array<Index, 3> corners;  // Into corners_.
    Index face;
  };

  std::array<PieceCorner, 3> corners_of(Index face) const;
  void visit_face(Index face, Goal& goal);
  bool query_one_vertex(Index face, Goal& goal);
  PieceCorner query(const Vec3& point, Index hint, Index from_face, Goal& goal);
  void add_face(Index face, Goal& goal);
  void add_piece(const Piece& parent, const std::array<Index, 3>& corners, const Goal& goal);
  void split(const Piece& piece, Goal& goal);
  void push(const Piece& piece);
  Piece pop();

  const Mesh& from_;
  const SurfaceIndex& to_;
  SurfaceBounds& bounds_;
  double largest_distance_ = 0;
  Vec3 farthest_point_;
  Index farthest_face_ = kNoIndex;
  std::vector<PieceCorner> corners_;
  std::vector<Piece> heap_;
};

/// Narrows the larger of two directions; the other one only as far as that needs.
Deviation narrow_both(SupremumSearch& forward, SupremumSearch& backward, Goal goal, std::size_t budget);

/// The result where one of the meshes has no faces: 0 where both have none, and infinity elsewhere.
Deviation maximum_of_empty(const Mesh& a, const Mesh& b);

}  // namespace lodestone::detail

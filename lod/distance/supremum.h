#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>
#include <lodestone/lod/deviation.h>

#include "distance/patch_bound.h"
#include "distance/target_surface.h"

namespace lodestone::detail {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// How far a supremum has to be narrowed, and the largest distance found so far on the way.
struct Goal {
  double relative_tolerance = 0;
  double absolute_tolerance = 0;
  double enough = 0;
  double found = 0;     ///< a distance that some point really has
  ProgressSteps steps;  ///< of the work

  /// Upper bounds at or below this need no narrowing.
  double threshold() const { return std::max(enough, found * (1 + relative_tolerance) + absolute_tolerance); }
  /// Takes a step of the work: once that is cancelled, any bound is enough.
  void step() {
    if (!steps.next()) enough = std::numeric_limits<double>::infinity();
  }
  /// What bounds by patches may add.
  double patch_slack() const { return 0.25 * absolute_tolerance; }
};

/// Returns the goal that the options ask for, with nothing found; `diagonal` is the larger surface's.
Goal goal_of(const DeviationOptions& options, double diagonal, double enough);

/// A point of one surface and what is known of its distance to the other.
struct KnownDistance {
  double distance = kUnbounded;  ///< an upper bound; of the distance to `face`, too, where there is one
  Index face = kNoIndex;         ///< a face of the other surface no farther than that
  bool searched = false;         ///< no nearer face need be looked for
  bool is_hint = false;          ///< of `face` nothing is known but that it is likely near
};

/// The faces of the other surface that a bound rests on; it holds for as long as all of them exist. None: unknown.
struct Witnesses {
  std::array<Index, 4> faces = {kNoIndex, kNoIndex, kNoIndex, kNoIndex};  ///< unused entries repeat the first

  bool known() const { return faces[0] != kNoIndex; }
};

/// What is known of a surface's distances to another one. It may be kept, while it stays true, between searches.
struct SurfaceBounds {
  std::vector<KnownDistance> vertices;  ///< one per vertex
  std::vector<double> faces;            ///< one per face: an upper bound of its points' distances
  std::vector<Witnesses> witnesses;     ///< of `faces`; may be empty: not wanted
  std::vector<bool> lowered;            ///< by face, where witnesses are wanted: whether a search has lowered its bound

  SurfaceBounds() = default;
  SurfaceBounds(const Mesh& mesh, bool wants_witnesses)
      : vertices(mesh.vertex_count()),
        faces(mesh.face_count(), kUnbounded),
        witnesses(wants_witnesses ? mesh.face_count() : 0),
        lowered(witnesses.size()) {}
  double maximum() const { return faces.empty() ? 0 : *std::max_element(faces.begin(), faces.end()); }
  /// Lowers a face's bound; `found` are the faces that the new bound rests on.
  void lower(Index face, double bound, std::span<const Index> found);
  /// Begins a face's bound anew, from 0 on: what it rests on will not be known.
  void begin_anew(Index face);
};

/// A corner of a part of a triangle.
struct PartCorner {
  Vec3 point;
  double distance = kUnbounded;  ///< as in KnownDistance
  Index face = kNoIndex;         ///< as in KnownDistance
};

/// The search for the largest distance from the faces of a mesh to a surface: branch and bound, best first.
class SupremumSearch {
 public:
  /// All arguments outlive the search; `to` and `to_patch` are of one surface, which is not empty.
  SupremumSearch(const Mesh& from, TargetSurface& to, PatchBound& to_patch, SurfaceBounds& bounds);

  /// Queries about so many vertices, spread over the mesh's faces, so that the goal is near what it will be.
  void scout(std::size_t count, Goal& goal);
  /// Lowers the faces' bounds as far as the goal asks and queries at vertices can.
  void visit_vertices(Goal& goal);
  /// Splits faces until all bounds meet the goal or `budget` parts were halved.
  void split_faces(Goal& goal, std::size_t budget);

  /// Both, one after the other.
  void narrow(Goal& goal, std::size_t budget) {
    visit_vertices(goal);
    split_faces(goal, budget);
  }

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
  struct Part {
    double bound;
    std::array<Index, 3> corners;  // Into corners_.
    Index face;
    int halvings;  // Of the face, to have the part.
  };

  using Corners = std::array<PartCorner, 3>;

  bool is_open(Index face, const Goal& goal) const { return bounds_.faces[face] > goal.threshold(); }
  Corners corners_of(Index face) const;
  double bound_by_corners(const Corners& corners, const Goal& goal) const;
  Index face_facing(const Corners& corners) const;
  double bound_by_face(const Corners& corners, Index face, const Goal& goal) const;
  double bound_by_patch(const Corners& corners, const Goal& goal);
  Index face_at_centre(const Corners& corners, Index from_face, Goal& goal);
  void visit_face(Index face, Goal& goal);
  bool query_one_vertex(Index face, Goal& goal);
  PartCorner query(const Vec3& point, Index hint, Index from_face, Goal& goal);
  void add_face(Index face, Goal& goal);
  void add_part(const Part& parent, const std::array<Index, 3>& corners, Goal& goal);
  void split(const Part& part, Goal& goal);
  void push(const Part& part);
  Part pop();

  const Mesh& from_;
  TargetSurface& to_;
  PatchBound& to_patch_;
  SurfaceBounds& bounds_;
  double largest_distance_ = 0;
  Vec3 farthest_point_;
  Index farthest_face_ = kNoIndex;
  std::vector<PartCorner> corners_;
  std::vector<Part> heap_;
};

/// Narrows the larger of two directions; the other one only as far as that needs.
Deviation narrow_both(SupremumSearch& forward, SupremumSearch& backward, Goal goal, std::size_t budget);

/// The result where one of the meshes has no faces: 0 where both have none, and infinity elsewhere.
Deviation maximum_of_empty(const Mesh& a, const Mesh& b);

}  // namespace lodestone::detail
